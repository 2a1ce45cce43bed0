"""The pinhole (1): intrinsics, points, rings and the line projected into corrected pixels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.devices import CArm, Guide

Array = NDArray[np.float64]

_RING_FIDUCIALS = (
    ("centre", 0.0, 0.0),
    ("x_plus", 1.0, 0.0),
    ("x_minus", -1.0, 0.0),
    ("y_plus", 0.0, 1.0),
    ("y_minus", 0.0, -1.0),
)


@dataclass(frozen=True, slots=True)
class Intrinsics:
    """The camera matrix's four numbers, in corrected pixels."""

    alpha_x_px: float
    alpha_y_px: float
    u0_px: float
    v0_px: float

    def matrix(self) -> Array:
        """K, (3, 3): corrected pixel (homogeneous) from a point in the source frame."""
        return np.array([[self.alpha_x_px, 0.0, self.u0_px], [0.0, self.alpha_y_px, self.v0_px], [0.0, 0.0, 1.0]])


@dataclass(frozen=True, slots=True, eq=False)
class View:
    """One view of the guide: intrinsics and `source_from_guide` (4, 4), mm."""

    intrinsics: Intrinsics
    source_from_guide: Array


def nominal_intrinsics(carm: CArm, rows: int, columns: int, pixel_size_mm: float | None = None) -> Intrinsics:
    """Intrinsics that the C-arm file predicts: distance over pixel size, centre of the image.

    Parameters
    ----------
    carm : CArm
        Source-to-image distance and field of view, mm.
    rows, columns : int
        Size of the image.
    pixel_size_mm : float or None
        Size of a corrected pixel as the plate shows it; without it the image's longer side spans the field of view.

    Returns
    -------
    Intrinsics
        Corrected pixels.
    """
    alpha_px = carm.source_to_image_mm / (pixel_size_mm or carm.field_of_view_mm / max(rows, columns))
    return Intrinsics(alpha_px, alpha_px, (columns - 1) / 2.0, (rows - 1) / 2.0)


def project(view: View, points_in_guide: Array) -> Array:
    """Corrected pixels (n, 2) of points (n, 3) in the guide frame, mm; eq. (1)."""
    intrinsics = view.intrinsics
    x, y, z = view.source_from_guide[:3, :3] @ points_in_guide.T + view.source_from_guide[:3, 3:]
    seen = np.empty((len(points_in_guide), 2))
    seen[:, 0] = intrinsics.alpha_x_px * x / z + intrinsics.u0_px
    seen[:, 1] = intrinsics.alpha_y_px * y / z + intrinsics.v0_px
    return seen


def projection_jacobian(view: View, points_in_guide: Array, directions: Array) -> Array:
    """Derivative of `project` by the view, along one direction of the image for each point.

    Parameters
    ----------
    view : View
        Where.
    points_in_guide : Array
        (n, 3), mm.
    directions : Array
        (n, 2), unit length, in corrected pixels.

    Returns
    -------
    Array
        (n, 10): corrected pixels along the directions, by alpha_x, alpha_y, u0, v0 (px), a small rotation vector (rad)
        and a translation (mm), both in the source frame and applied on the left.
    """
    intrinsics = view.intrinsics
    turned = view.source_from_guide[:3, :3] @ points_in_guide.T
    in_source = turned + view.source_from_guide[:3, 3, None]
    u, v = in_source[:2] / in_source[2]
    along_u, along_v = directions.T
    x, y, z = turned
    jacobian = np.empty((10, len(directions)))
    jacobian[0], jacobian[1], jacobian[2], jacobian[3] = along_u * u, along_v * v, along_u, along_v
    by_x, by_y, by_z = jacobian[7:]
    np.divide(along_u * intrinsics.alpha_x_px, in_source[2], out=by_x)
    np.divide(along_v * intrinsics.alpha_y_px, in_source[2], out=by_y)
    by_z[:] = -(by_x * u + by_y * v)
    # b . (w x p) = w . (p x b)
    jacobian[4], jacobian[5], jacobian[6] = y * by_z - z * by_y, z * by_x - x * by_z, x * by_y - y * by_x
    return np.ascontiguousarray(jacobian.T)


def ring_conic(view: View, radius_mm: float, z_mm: float) -> Array:
    """Image of a circle about the guide's axis.

    Parameters
    ----------
    view : View
        Intrinsics and pose.
    radius_mm, z_mm : float
        The circle's radius, and the z of its plane in the guide frame.

    Returns
    -------
    Array
        Symmetric (3, 3) conic C with x^T C x = 0 in corrected pixels, negative inside.
    """
    pose = view.source_from_guide
    image_from_plane = view.intrinsics.matrix() @ np.column_stack(
        (pose[:3, 0], pose[:3, 1], pose[:3, 2] * z_mm + pose[:3, 3])
    )
    plane_from_image = np.linalg.inv(image_from_plane)
    conic = plane_from_image.T @ np.diag((1.0, 1.0, -(radius_mm**2))) @ plane_from_image
    return np.asarray(conic / np.linalg.norm(conic[:2, :2]))


def line_image(view: View, guide: Guide) -> Array:
    """Homogeneous line (3,) in corrected pixels through the indicator line's image."""
    start, end = project(view, np.array([[guide.line_start_mm, 0.0, 0.0], [guide.line_end_mm, 0.0, 0.0]]))
    return np.cross((*start, 1.0), (*end, 1.0))


def fiducials_in_guide(guide: Guide) -> dict[str, Array]:
    """The 12 fiducials (3,) in the guide frame, mm, by the names of the command-line contract."""
    rings = {
        "small": (guide.small_ring_radius_mm, 0.0),
        "big": (guide.big_ring_radius_mm, -guide.separation_mm),
    }
    points = {
        f"{ring}_{name}": np.array([x * radius, y * radius, z])
        for ring, (radius, z) in rings.items()
        for name, x, y in _RING_FIDUCIALS
    }
    points["line_start"] = np.array([guide.line_start_mm, 0.0, 0.0])
    points["line_end"] = np.array([guide.line_end_mm, 0.0, 0.0])
    return points

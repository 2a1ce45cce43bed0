"""The pinhole (1): intrinsics, points, rings and the line projected into corrected pixels."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.devices import CArm, Guide

Array = NDArray[np.float64]


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


def nominal_intrinsics(carm: CArm, rows: int, columns: int) -> Intrinsics:
    """Intrinsics that the C-arm file predicts: distance over pixel size, centre of the image.

    Parameters
    ----------
    carm : CArm
        Source-to-image distance and field of view, mm.
    rows, columns : int
        Size of the image; the longer side spans the field of view.

    Returns
    -------
    Intrinsics
        Corrected pixels.
    """
    alpha_px = carm.source_to_image_mm * max(rows, columns) / carm.field_of_view_mm
    return Intrinsics(alpha_px, alpha_px, (columns - 1) / 2.0, (rows - 1) / 2.0)


def project(view: View, points_in_guide: Array) -> Array:
    """Corrected pixels (n, 2) of points (n, 3) in the guide frame, mm; eq. (1)."""
    in_source = points_in_guide @ view.source_from_guide[:3, :3].T + view.source_from_guide[:3, 3]
    intrinsics = view.intrinsics
    u = intrinsics.alpha_x_px * in_source[:, 0] / in_source[:, 2] + intrinsics.u0_px
    v = intrinsics.alpha_y_px * in_source[:, 1] / in_source[:, 2] + intrinsics.v0_px
    return np.column_stack((u, v))


def ring_conic(view: View, radius_mm: float, z_mm: float) -> Array:
    """Symmetric (3, 3) conic C, x^T C x = 0 in corrected pixels, of the circle of `radius_mm` in the plane z = `z_mm`."""
    raise NotImplementedError


def line_image(view: View, guide: Guide) -> Array:
    """Homogeneous line (3,) in corrected pixels through the indicator line's image."""
    raise NotImplementedError


def fiducials_in_guide(guide: Guide) -> dict[str, Array]:
    """The 12 fiducials (3,) in the guide frame, mm, by the names of the contract."""
    raise NotImplementedError

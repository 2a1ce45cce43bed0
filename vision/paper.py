"""The paper's solution: intrinsics and rigid pose from the 12 fiducials, linearly.

It is kept for comparison with the fit of all contour points. Its intrinsics are loose (some per cent), because depth
and tilt trade against focal length and principal point over a guide this small; the targeting result is not.
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import rq
from scipy.spatial.transform import Rotation

from vision.devices import Guide
from vision.projection import Intrinsics, View, fiducials_in_guide
from vision.refusal import Refusal, RefusalCode

Array = NDArray[np.float64]

_LEAST_NOISE_PX = 0.03  # constructed fiducials carry 0.02 to 0.05 px, however small the residual happens to be
_DEGREES_OF_FREEDOM = 24 - 11  # 12 pixels against a projection matrix up to scale
_PIXEL_STEP_PX = 1e-3
_LENGTH_STEP_MM = 1e-3


@dataclass(frozen=True, slots=True, eq=False)
class PaperSolution:
    """View, RMS distance (px) of the 12 fiducials from the linear projection, and covariance as in `Registration`."""

    view: View
    residual_rms_px: float
    covariance: Array


def solve(fiducials_px: Mapping[str, Array], guide: Guide) -> PaperSolution | Refusal:
    """Intrinsics and pose from the 12 fiducials.

    Parameters
    ----------
    fiducials_px : Mapping[str, Array]
        (2,) each, corrected pixels, by the names of `projection.fiducials_in_guide`.
    guide : Guide
        Dimensions, mm.

    Returns
    -------
    PaperSolution or Refusal
        `guide_mismatch` where the linear solution is no view of a guide in front of the source.

    Notes
    -----
    Eq. (1): normalised direct linear transformation, then the camera matrix split into K and the nearest rotation;
    the skew that noise puts into K is dropped.
    """
    pixels = np.array([fiducials_px[name] for name in fiducials_in_guide(guide)])
    points = _points(guide)
    projection = _projection_matrix(pixels, points)
    image = points @ projection[:, :3].T + projection[:, 3]
    if not (np.isfinite(image).all() and (image[:, 2] > 0.0).all()):
        return Refusal(RefusalCode.GUIDE_MISMATCH, "the 12 fiducials give no view of a guide in front of the source")
    sum_of_squares = float(((image[:, :2] / image[:, 2:] - pixels) ** 2).sum())
    noise_px = max(_LEAST_NOISE_PX, math.sqrt(sum_of_squares / _DEGREES_OF_FREEDOM))
    view = _decomposed(projection)
    return PaperSolution(view, math.sqrt(sum_of_squares / len(points)), _covariance(view, pixels, guide, noise_px))


def _points(guide: Guide) -> Array:
    """The 12 fiducials (12, 3), guide frame, mm."""
    return np.array(list(fiducials_in_guide(guide).values()))


def _view(pixels: Array, guide: Guide) -> View:
    return _decomposed(_projection_matrix(pixels, _points(guide)))


def _projection_matrix(pixels: Array, points: Array) -> Array:
    """(3, 4) matrix, scaled so that its third row gives depths in mm, by the normalised linear method."""
    image_norm, guide_norm = _normalisation(pixels), _normalisation(points)
    u, v = (pixels @ image_norm[:2, :2] + image_norm[:2, 2]).T[:, :, None]
    x = np.column_stack((points @ guide_norm[:3, :3] + guide_norm[:3, 3], np.ones(len(points))))
    zeros = np.zeros_like(x)
    rows = np.vstack((np.hstack((x, zeros, -u * x)), np.hstack((zeros, x, -v * x))))
    normalised = np.linalg.svd(rows)[2][-1].reshape(3, 4)
    projection = np.linalg.solve(image_norm, normalised @ guide_norm)
    scale = np.linalg.norm(projection[2, :3]) * np.sign(np.linalg.det(projection[:, :3]))
    with np.errstate(divide="ignore", invalid="ignore"):  # points on a line give a scale of 0; the caller refuses
        return np.asarray(projection / scale)


def _normalisation(points: Array) -> Array:
    """Homogeneous scaling to mean 0 and mean square 1 per axis: raw pixels and mm would spoil the condition number."""
    mean = points.mean(axis=0)
    scale = math.sqrt(float(((points - mean) ** 2).mean()))
    normalisation = np.eye(len(mean) + 1)
    normalisation[:-1, :-1] /= scale
    normalisation[:-1, -1] = -mean / scale
    return normalisation


def _decomposed(projection: Array) -> View:
    """Intrinsics without skew and the rigid pose in a (3, 4) projection matrix."""
    upper, orthogonal = rq(projection[:, :3])
    signs = np.sign(np.diag(upper))
    camera, rotation = upper * signs, orthogonal * signs[:, None]
    pose = np.eye(4)
    pose[:3, :3] = rotation
    pose[:3, 3] = np.linalg.solve(camera, projection[:, 3])
    camera = camera / camera[2, 2]
    return View(Intrinsics(float(camera[0, 0]), float(camera[1, 1]), float(camera[0, 2]), float(camera[1, 2])), pose)


def _covariance(view: View, pixels: Array, guide: Guide, noise_px: float) -> Array:
    """(10, 10) from pixel noise and the guide's tolerances, through the derivative of the solution itself."""
    columns = []
    for index in np.ndindex(*pixels.shape):
        moved = pixels.copy()
        moved[index] += _PIXEL_STEP_PX
        columns.append(_difference(view, _view(moved, guide)) * (noise_px / _PIXEL_STEP_PX))
    sd = guide.tolerance
    for name, sd_mm in (
        ("small_ring_radius_mm", sd.radius_sd_mm),
        ("big_ring_radius_mm", sd.radius_sd_mm),
        ("separation_mm", sd.separation_sd_mm),
    ):
        other = replace(guide, **{name: getattr(guide, name) + _LENGTH_STEP_MM})
        columns.append(_difference(view, _view(pixels, other)) * (sd_mm / _LENGTH_STEP_MM))
    spread = np.column_stack(columns)
    return np.asarray(spread @ spread.T)


def _difference(view: View, other: View) -> Array:
    """Ten parameters (px, rad, mm) that lead from `view` to `other`, pose on the left in the source frame."""
    before, after = view.intrinsics, other.intrinsics
    rotation = other.source_from_guide[:3, :3] @ view.source_from_guide[:3, :3].T
    return np.concatenate(
        (
            (after.alpha_x_px - before.alpha_x_px, after.alpha_y_px - before.alpha_y_px),
            (after.u0_px - before.u0_px, after.v0_px - before.v0_px),
            Rotation.from_matrix(rotation).as_rotvec(),
            other.source_from_guide[:3, 3] - view.source_from_guide[:3, 3],
        )
    )

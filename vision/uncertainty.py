"""95 % bounds of the alignment error: the covariance of the fit carried through (2) to (7), and the bore's tolerance.

Intrinsics and pose are strongly correlated, yet the aim barely depends on what they trade; so only the covariance of
the aim is worth reporting.
"""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq
from scipy.spatial.transform import Rotation

from vision.alignment import angle_vector, goal, position_vector
from vision.devices import Guide
from vision.projection import Intrinsics, View
from vision.registered import DEFAULT_DEPTH_MM, PredictedError

Array = NDArray[np.float64]

_CONFIDENCE = 0.95
CHI_SQUARE_95 = 5.991  # of 2 degrees of freedom: squared standard deviations of the ellipse that holds 95 %
# Steps of the central differences: alpha_x, alpha_y, u0, v0 in px, rotation in rad, translation in mm.
_STEPS = np.array([1e-2] * 4 + [1e-5] * 3 + [1e-3] * 3)


def predicted_error(
    view: View, covariance: Array, guide: Guide, pixel_corrected: Array, depth_mm: float = DEFAULT_DEPTH_MM
) -> PredictedError:
    """Bounds for a guide that moves to the goal computed from `view`.

    Parameters
    ----------
    view : View
        The estimate.
    covariance : Array
        (10, 10), parametrised as in `Registration.covariance`.
    guide : Guide
        Separation and bore tolerance, mm.
    pixel_corrected : Array
        (2,), corrected pixel of the target.
    depth_mm : float
        Depth of the target below the big ring.

    Returns
    -------
    PredictedError
        Angle between the guide's axis and the true target ray, distance of the true target from the axis.
    """
    guide_from_goal, _ = goal(view, pixel_corrected)
    return alignment_bounds(view, covariance, guide, pixel_corrected, depth_mm, guide_from_goal)


def alignment_bounds(
    view: View, covariance: Array, guide: Guide, pixel_corrected: Array, depth_mm: float, guide_from_axis: Array
) -> PredictedError:
    """Bounds of the error of an axis at `guide_from_axis` (4, 4), against what `view` says of it.

    The arguments are those of `predicted_error`; the identity for `guide_from_axis` is the guide where it was seen.
    """
    spread = aim_covariance(view, covariance, guide, pixel_corrected, depth_mm, guide_from_axis)
    return PredictedError(radius_95(spread[:3, :3]), radius_95(spread[3:, 3:]), depth_mm)


def aim_covariance(
    view: View, covariance: Array, guide: Guide, pixel_corrected: Array, depth_mm: float, guide_from_axis: Array
) -> Array:
    """Covariance (6, 6) of the angle vector (rad) and the position vector (mm) of an axis, source frame.

    The arguments are those of `alignment_bounds`.
    """
    jacobian = _jacobian(view, guide, pixel_corrected, depth_mm, guide_from_axis)
    spread = jacobian @ covariance @ jacobian.T
    axis = view.source_from_guide[:3, :3] @ guide_from_axis[:3, 2]
    across = np.eye(3) - np.outer(axis, axis)
    # the bore's offset at the big ring against the small one tilts it about the small ring's centre
    tilt_sd_rad = guide.tolerance.bore_concentricity_sd_mm / guide.separation_mm
    offset_sd_mm = tilt_sd_rad * (guide.separation_mm + depth_mm)
    spread[:3, :3] += tilt_sd_rad**2 * across
    spread[3:, 3:] += offset_sd_mm**2 * across
    return np.asarray(spread)


def freed_errors(
    view: View, steps: Array, guide: Guide, pixel_corrected: Array, depth_mm: float, guide_from_axis: Array
) -> Array:
    """By how much the errors of an axis change were views some steps (k, 10) away the truth.

    Steps are parametrised as in `Registration.covariance`; the other arguments are those of `alignment_bounds`, of
    several targets (..., 2) and their axes (..., 4, 4). Of each step the angle in rad and the distance in mm:
    (..., k, 2).
    """
    around = np.vstack((np.zeros(len(_STEPS)), steps))
    errors = _error_vectors(view, around, guide, pixel_corrected, depth_mm, guide_from_axis)
    changes = errors[..., 1:, :] - errors[..., :1, :]
    return np.asarray(np.linalg.norm(changes.reshape(*changes.shape[:-1], 2, 3), axis=-1))


def radius_95(covariance: Array) -> float:
    """Radius that holds 95 % of a plane Gaussian with this covariance, (2, 2) or (3, 3) of rank 2.

    Notes
    -----
    c sqrt(trace C). P(radius < r) is a mean over directions of 1 - exp(-r^2 / 2 s^2), s the spread along a direction;
    c is 1.73 for a round ellipse and 1.96 for one as thin as a line.
    """
    thin, wide = np.linalg.eigvalsh(covariance)[-2:]
    if not wide > 0.0:
        return 0.0
    return _confidence_factor(max(0.0, float(thin / wide))) * math.sqrt(float(np.trace(covariance)))


def _confidence_factor(thinness: float) -> float:
    """c for the ratio of the smaller to the larger variance, 0 to 1."""
    directions = (np.arange(256) + 0.5) * (math.pi / 512.0)
    variances = (np.cos(directions) ** 2 + thinness * np.sin(directions) ** 2) / (1.0 + thinness)

    def excess(c: float) -> float:
        return float(np.mean(-np.expm1(-(c**2) / (2.0 * variances)))) - _CONFIDENCE

    return float(brentq(excess, 1.0, 3.0, xtol=1e-6))


def _jacobian(view: View, guide: Guide, pixel_corrected: Array, depth_mm: float, guide_from_axis: Array) -> Array:
    """(6, 10) derivative of angle (rad) and position (mm) vectors by the parameters of the view."""
    steps = np.diag(_STEPS)
    errors = _error_vectors(view, np.vstack((steps, -steps)), guide, pixel_corrected, depth_mm, guide_from_axis)
    return np.asarray(((errors[: len(steps)] - errors[len(steps) :]) / (2.0 * _STEPS[:, None])).T)


def _error_vectors(
    view: View, steps: Array, guide: Guide, pixel_corrected: Array, depth_mm: float, guide_from_axis: Array
) -> Array:
    """Angle vectors (rad) and position vectors (mm), stacked (..., k, 6), were views some steps (k, 10) away the truth.

    Steps are added to the parameters, the pose's on the left in the source frame. Targets are (..., 2), axes
    (..., 4, 4).
    """
    intrinsics, pose = view.intrinsics, view.source_from_guide
    turned = Rotation.from_rotvec(steps[:, 4:7]).as_matrix() @ pose[:3, :3]
    translations = pose[:3, 3] + steps[:, 7:]
    axes, on_axes = ((turned @ guide_from_axis[..., None, :3, column, None])[..., 0] for column in (2, 3))
    alphas = steps[:, :2] + (intrinsics.alpha_x_px, intrinsics.alpha_y_px)
    rays = np.ones_like(axes)
    rays[..., :2] = (pixel_corrected[..., None, :] - steps[:, 2:4] - (intrinsics.u0_px, intrinsics.v0_px)) / alphas
    rays /= np.linalg.norm(rays, axis=-1, keepdims=True)
    distances_mm = np.linalg.norm(translations, axis=1, keepdims=True) - guide.separation_mm - depth_mm
    off_mm = position_vector(on_axes + translations, axes, rays * distances_mm)
    return np.concatenate((angle_vector(axes, rays), off_mm), axis=-1)


def moved_view(view: View, step: Array) -> View:
    """The view with a step (10,) of its parameters added, pose on the left in the source frame."""
    intrinsics = view.intrinsics
    pose = view.source_from_guide.copy()
    pose[:3, :3] = Rotation.from_rotvec(step[4:7]).as_matrix() @ pose[:3, :3]
    pose[:3, 3] += step[7:]
    moved = Intrinsics(
        intrinsics.alpha_x_px + float(step[0]),
        intrinsics.alpha_y_px + float(step[1]),
        intrinsics.u0_px + float(step[2]),
        intrinsics.v0_px + float(step[3]),
    )
    return View(moved, pose)

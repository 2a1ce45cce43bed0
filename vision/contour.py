"""The contour registration: all places on the wires against the projected model, by robust least squares.

Free are four intrinsics, the pose and the guide's three dimensions; weak priors hold the intrinsics to the C-arm file,
the dimensions to the guide file's tolerances. Symbols and gates: docs/method.md.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.devices import CArm, Guide
from vision.distortion import PlateFit
from vision.projection import Intrinsics, View, project, projection_jacobian
from vision.strain import Strain, strain
from vision.wire_model import dimension_directions, points_in_guide, with_dimensions

Array = NDArray[np.float64]

SQUARE_SD = 5e-4  # relative: alpha_y against alpha_x; the plate and the panel make the corrected grid square
VIEW_PARAMETERS = 10  # alpha_x, alpha_y, u0, v0 (px), rotation vector (rad), translation (mm): see Registration
_TUKEY = 4.685  # standard deviations beyond which an observation has no weight; 95 % efficient on clean data
LEAST_NOISE_PX = 0.02  # of one ridge point: interpolation and the profile's model are no better
_UNMODELLED_PX = 0.1  # 0.02 px that map and ground leave in phase over some 30 neighbours
_GREATEST_STEPS, _HALVINGS = 12, 6
_SETTLED = 1e-4  # squared standard deviations of the solution: a step of a hundredth of them moves nothing
_REWEIGHTINGS = 4
_LAGS = 12  # neighbours along a wire over which noise may be correlated


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """What was measured in the image, each along one direction.

    Attributes
    ----------
    wire, along
        (n,) each: places on the wires, as in `WireSamples`.
    measured : Array
        (n, 2), corrected pixels.
    normals : Array
        (n, 2): the direction in which each place was measured.
    extra_in_guide, extra_measured, extra_normals, extra_sd_px
        The same for single points (line ends, bead): (m, 3) mm, (m, 2), (m, 2), (m,).
    """

    wire: NDArray[np.intp]
    along: Array
    measured: Array
    normals: Array
    extra_in_guide: Array
    extra_measured: Array
    extra_normals: Array
    extra_sd_px: Array


@dataclass(frozen=True, slots=True, eq=False)
class ContourFit:
    """The solution.

    Attributes
    ----------
    guide : Guide
        With the dimensions as the fit has them.
    residual_px : Array
        (n,) along the normals.
    weight : Array
        (n,) robust weight, 0 to 1.
    noise_px : float
        Robust standard deviation of one ridge point.
    correlation : float
        Factor of the variance that neighbours' correlation makes.
    pulls_sd : dict[str, float]
        Of each prior, in its standard deviations.
    strain : Strain
        What these pulls mean.
    covariance : Array
        (13, 13): the ten of `Registration.covariance`, then small radius, big radius, separation (mm).
    """

    view: View
    guide: Guide
    residual_px: Array
    weight: Array
    noise_px: float
    correlation: float
    pulls_sd: dict[str, float]
    strain: Strain
    covariance: Array


@dataclass(frozen=True, slots=True, eq=False)
class Priors:
    """Means and standard deviations of what the files say."""

    nominal: Intrinsics
    alpha_sd_px: float
    centre_sd_px: float
    guide: Guide

    @classmethod
    def of(cls, carm: CArm, guide: Guide, nominal: Intrinsics) -> "Priors":
        """From the device files."""
        relative = carm.source_to_image_sd_mm / carm.source_to_image_mm
        return cls(nominal, nominal.alpha_x_px * relative, carm.principal_point_sd_px, guide)

    def pulls(self, view: View, guide: Guide) -> dict[str, float]:
        """How many standard deviations each quantity lies from its prior."""
        intrinsics, sd = view.intrinsics, self.guide.tolerance
        return {
            "source_to_image": (intrinsics.alpha_x_px - self.nominal.alpha_x_px) / self.alpha_sd_px,
            "square": (intrinsics.alpha_y_px - intrinsics.alpha_x_px) / (SQUARE_SD * self.nominal.alpha_x_px),
            "centre_u": (intrinsics.u0_px - self.nominal.u0_px) / self.centre_sd_px,
            "centre_v": (intrinsics.v0_px - self.nominal.v0_px) / self.centre_sd_px,
            "small_radius": (guide.small_ring_radius_mm - self.guide.small_ring_radius_mm) / sd.radius_sd_mm,
            "big_radius": (guide.big_ring_radius_mm - self.guide.big_ring_radius_mm) / sd.radius_sd_mm,
            "separation": (guide.separation_mm - self.guide.separation_mm) / sd.separation_sd_mm,
        }

    def rows(self) -> Array:
        """Derivative (7, 13) of the pulls by the 13 parameters: alphas and centre (px), pose, dimensions (mm)."""
        sd, rows = self.guide.tolerance, np.zeros((7, len(_SCALES)))
        rows[0, 0] = 1.0 / self.alpha_sd_px
        rows[1, :2] = np.array([-1.0, 1.0]) / (SQUARE_SD * self.nominal.alpha_x_px)
        rows[[2, 3], [2, 3]] = 1.0 / self.centre_sd_px
        rows[[4, 5, 6], [10, 11, 12]] = 1.0 / np.array([sd.radius_sd_mm, sd.radius_sd_mm, sd.separation_sd_mm])
        return rows


def fit_contour(view: View, guide: Guide, observations: Observations, priors: Priors, plate: PlateFit) -> ContourFit:
    """Solve for the view.

    Parameters
    ----------
    view, guide
        Where to start.
    observations : Observations
        From the image.
    priors : Priors
        From the device files.
    plate : PlateFit
        The distortion's uncertainty, which all observations share.

    Returns
    -------
    ContourFit
        With covariance; nothing here is judged.
    """
    weight = np.ones(len(observations.along))
    noise_px, correlation = 0.3, 1.0
    for _ in range(_REWEIGHTINGS):
        # correlated points are worth fewer: with all of them counted in full the priors would be overruled
        view, guide = solve_view(view, guide, observations, priors, weight, _worth_px(noise_px, correlation))
        residual = residual_px(view, guide, observations)
        noise_px = max(LEAST_NOISE_PX, 1.4826 * float(np.median(np.abs(residual))))
        weight = np.clip(1.0 - (residual / (_TUKEY * noise_px)) ** 2, 0.0, None) ** 2
        correlation = _correlation(residual, weight, observations)
    inverse, shared = _covariances(view, guide, observations, priors, weight, noise_px, correlation, plate)
    pulls_sd = priors.pulls(view, guide)
    return ContourFit(
        view,
        guide,
        residual,
        weight,
        noise_px,
        correlation,
        pulls_sd,
        strain(pulls_sd, priors.rows(), inverse, shared),
        inverse + shared,
    )


def _worth_px(noise_px: float, correlation: float) -> float:
    """Standard deviation that makes the points' sum of squares worth what they are, px."""
    return float(np.hypot(noise_px * np.sqrt(correlation), _UNMODELLED_PX))


def solve_view(
    view: View, guide: Guide, observations: Observations, priors: Priors, weight: Array, noise_px: float
) -> tuple[View, Guide]:
    """One least-squares solution with given weights (n,) and noise of the ridge points, px.

    Gauss-Newton, a step halved while it makes things worse: near the solution the projection is almost linear.
    """

    def weighted(view: View, guide: Guide) -> Array:
        return _weighted(view, guide, observations, priors, weight, noise_px)

    left = weighted(view, guide)
    for _ in range(_GREATEST_STEPS):
        design = _design(view, guide, observations, priors, weight, noise_px) * _SCALES
        downhill = -design.T @ left
        move = np.linalg.solve(design.T @ design, downhill)
        for _ in range(_HALVINGS):
            ahead = _moved(view, guide, move * _SCALES)
            left_ahead = weighted(*ahead)
            if left_ahead @ left_ahead <= left @ left:
                (view, guide), left = ahead, left_ahead
                break
            move = move / 2.0
        if move @ downhill < _SETTLED:
            break
    return view, guide


def _design(
    view: View, guide: Guide, observations: Observations, priors: Priors, weight: Array, noise_px: float
) -> Array:
    """Derivative of `_weighted` by the 13 parameters."""
    points = points_in_guide(guide, observations.wire, observations.along)
    by_view = projection_jacobian(view, points, observations.normals)
    by_place_in_guide = by_view[:, 7:] @ view.source_from_guide[:3, :3]
    directions = dimension_directions(observations.wire, observations.along)
    by_dimension = (by_place_in_guide[:, :, None] * directions).sum(axis=1)
    extra = projection_jacobian(view, observations.extra_in_guide, observations.extra_normals)
    return np.vstack(
        (
            np.hstack((by_view, by_dimension)) * (-np.sqrt(weight) / noise_px)[:, None],
            np.hstack((extra / -observations.extra_sd_px[:, None], np.zeros((len(extra), 3)))),
            priors.rows(),
        )
    )


# Steps of about equal effect on the image: px, rad, mm; then the guide's radii and separation, mm.
_SCALES = np.array([10.0, 10.0, 5.0, 5.0, 2e-3, 2e-3, 2e-3, 0.5, 0.5, 3.0, 0.02, 0.02, 0.03])


def _moved(view: View, guide: Guide, step: Array) -> tuple[View, Guide]:
    """A step of the 13 parameters, the pose's applied on the left in the source frame."""
    intrinsics, pose = view.intrinsics, view.source_from_guide.copy()
    pose[:3, :3] = Rotation.from_rotvec(step[4:7]).as_matrix() @ pose[:3, :3]
    pose[:3, 3] += step[7:10]
    moved = replace(
        intrinsics,
        alpha_x_px=intrinsics.alpha_x_px + float(step[0]),
        alpha_y_px=intrinsics.alpha_y_px + float(step[1]),
        u0_px=intrinsics.u0_px + float(step[2]),
        v0_px=intrinsics.v0_px + float(step[3]),
    )
    dimensions = with_dimensions(
        guide,
        guide.small_ring_radius_mm + float(step[10]),
        guide.big_ring_radius_mm + float(step[11]),
        guide.separation_mm + float(step[12]),
    )
    return View(moved, pose), dimensions


def residual_px(view: View, guide: Guide, observations: Observations) -> Array:
    """Distance (n,) of each ridge point from the model along its normal, corrected px."""
    model = project(view, points_in_guide(guide, observations.wire, observations.along))
    return np.asarray(((observations.measured - model) * observations.normals).sum(axis=1))


def _extra_residual(view: View, observations: Observations) -> Array:
    model = project(view, observations.extra_in_guide)
    return np.asarray(((observations.extra_measured - model) * observations.extra_normals).sum(axis=1))


def _weighted(
    view: View, guide: Guide, observations: Observations, priors: Priors, weight: Array, noise_px: float
) -> Array:
    """Everything in its standard deviations: ridge points, single points, priors."""
    return np.concatenate(
        (
            residual_px(view, guide, observations) * np.sqrt(weight) / noise_px,
            _extra_residual(view, observations) / observations.extra_sd_px,
            list(priors.pulls(view, guide).values()),
        )
    )


def _correlation(residual: Array, weight: Array, observations: Observations) -> float:
    """Variance factor 1 + 2 sum of the autocorrelations along the wires; samples are a pixel apart."""
    total = 1.0
    for lag in range(1, _LAGS + 1):
        pair = (observations.wire[lag:] == observations.wire[:-lag]) & (weight[lag:] > 0.0) & (weight[:-lag] > 0.0)
        product = float((residual[lag:] * residual[:-lag])[pair].mean()) if pair.any() else 0.0
        share = product / float((residual[weight > 0.0] ** 2).mean())
        if share < 0.05:
            break
        total += 2.0 * share
    return total


def _covariances(
    view: View,
    guide: Guide,
    observations: Observations,
    priors: Priors,
    weight: Array,
    noise_px: float,
    correlation: float,
    plate: PlateFit,
) -> tuple[Array, Array]:
    """(13, 13) each: of noise with its correlation and priors; of the distortion map, whose error all points share."""
    noise_px = _worth_px(noise_px, correlation)
    jacobian = _design(view, guide, observations, priors, weight, noise_px)
    inverse: Array = np.linalg.inv(jacobian.T @ jacobian).astype(np.float64)
    count = len(observations.along)
    gain = inverse @ (jacobian[:count] * (np.sqrt(weight) / noise_px)[:, None]).T
    basis = plate.map.basis(plate.map.raw_from_corrected(observations.measured))
    shared = np.zeros_like(inverse)
    for axis in (0, 1):
        spread = gain @ (observations.normals[:, axis, None] * basis)
        shared += spread @ plate.coefficient_covariance @ spread.T
    return inverse, shared

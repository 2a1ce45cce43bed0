"""The error budget: each source's share in the targeting error, by linear propagation (docs/method.md)."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from vision.aim_error import AimErrors, aim_error
from vision.budget_conditions import Conditions
from vision.priors import VIEW_PARAMETERS
from vision.uncertainty import moved_view, radius_95

Array = NDArray[np.float64]


class ErrorSource(StrEnum):
    """What the targeting error is made of."""

    PIXEL_NOISE = "pixel noise"
    DISTORTION = "distortion"
    INTRINSICS = "intrinsics"
    RING_TOLERANCES = "ring tolerances"
    BORE = "bore"
    TCP_CALIBRATION = "TCP calibration"
    ARM = "arm"
    TARGET_DEPTH = "target depth"


@dataclass(frozen=True, slots=True)
class Share:
    """What one source, or all together, leave: 95 % radii alone, and shares of the total variance."""

    angle_rad: float
    position_mm: float
    angle_share: float
    position_share: float


@dataclass(frozen=True, slots=True, eq=False)
class Budget:
    """Covariances (6, 6) of angle vector (rad) and position vector (mm), source frame, of each source and of all."""

    covariances: dict[ErrorSource, Array]
    total: Array

    def share(self, source: ErrorSource) -> Share:
        """What the source would leave alone, and its part of the whole."""
        return _share(self.covariances[source], self.total)

    def whole(self) -> Share:
        """What all leave together."""
        return _share(self.total, self.total)


def _share(part: Array, total: Array) -> Share:
    angle, position = (float(np.trace(part[k, k]) / np.trace(total[k, k])) for k in (slice(3), slice(3, 6)))
    return Share(radius_95(part[:3, :3]), radius_95(part[3:, 3:]), angle, position)


# Steps of the central differences: the view (alphas and centre px, rad, mm), target px, TCP and two arm poses
# (rad, mm), bore mm.
_STEPS = np.array([1e-2] * 4 + [1e-5] * 3 + [1e-3] * 3 + [1e-2] * 2 + ([1e-5] * 3 + [1e-3] * 3) * 3 + [1e-3] * 2)
_VIEW, _PIXEL, _TCP, _ARM, _BORE = slice(0, 10), slice(10, 12), slice(12, 18), slice(18, 30), slice(30, 32)


def error_budget(conditions: Conditions) -> Budget:
    """Propagate every source to the targeting error.

    Parameters
    ----------
    conditions : Conditions
        View, devices, and the standard deviations of everything.

    Returns
    -------
    Budget
        To first order, but for the target's depth, whose effect is its product with the angle's error.
    """
    jacobian, fit = _jacobian(conditions), conditions.fit()
    by_view = jacobian[:, _VIEW] @ np.eye(VIEW_PARAMETERS, len(fit.gain))
    by_point = by_view @ fit.gain
    by_prior = by_view @ fit.prior_gain
    motion = conditions.motion
    arm_sd = np.array([motion.arm_rad] * 3 + [motion.arm_mm] * 3)
    tcp_sd = np.array([motion.tcp_rad] * 3 + [motion.tcp_mm] * 3)
    covariances = {
        ErrorSource.PIXEL_NOISE: conditions.point_sd_px**2 * by_point @ by_point.T,
        ErrorSource.DISTORTION: _by_distortion(conditions, by_point, jacobian[:, _PIXEL], fit.bend),
        ErrorSource.INTRINSICS: by_prior[:, :4] @ by_prior[:, :4].T,
        ErrorSource.RING_TOLERANCES: by_prior[:, 4:] @ by_prior[:, 4:].T,
        ErrorSource.BORE: _of(jacobian[:, _BORE] * conditions.guide.tolerance.bore_concentricity_sd_mm),
        ErrorSource.TCP_CALIBRATION: _of(jacobian[:, _TCP] * tcp_sd),
        ErrorSource.ARM: _of(jacobian[:, _ARM] * np.tile(arm_sd, 2)),
    }
    total = np.sum(list(covariances.values()), axis=0)
    by_depth = np.zeros((6, 6))
    by_depth[3:, 3:] = conditions.depth_sd_mm**2 * total[:3, :3]
    return Budget(covariances | {ErrorSource.TARGET_DEPTH: by_depth}, total + by_depth)


def _of(effects: Array) -> Array:
    """Covariance (6, 6) of independent effects (6, k), each of one standard deviation."""
    return effects @ effects.T


def _by_distortion(conditions: Conditions, by_point: Array, by_pixel: Array, bend: Array) -> Array:
    """The map's error bends the wires and the target's pixel together."""
    plate = conditions.plate
    at_target = plate.map.basis(plate.map.raw_from_corrected(conditions.pixel_corrected[None]))
    covariance = np.zeros((6, 6))
    for axis in (0, 1):
        effect = by_point @ bend[:, axis] + by_pixel[:, axis, None] * at_target
        covariance += effect @ plate.coefficient_covariance @ effect.T
    return covariance


def _jacobian(conditions: Conditions) -> Array:
    """(6, 32) derivative of the aim's error by errors of view, target pixel, TCP, arm and bore."""

    def error(step: Array) -> Array:
        seen = moved_view(conditions.view, step[_VIEW])
        errors = AimErrors(step[_PIXEL], step[_TCP], step[_ARM].reshape(2, 6), step[_BORE], 0.0)
        return aim_error(
            conditions.view, seen, errors, conditions.guide, conditions.pixel_corrected, conditions.depth_mm
        )

    return np.column_stack([(error(step) - error(-step)) / (2.0 * step.max()) for step in np.diag(_STEPS)])

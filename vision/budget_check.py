"""The budget checked by Monte Carlo: every source drawn at once, through the projection and the targeting itself."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.aim_error import AimErrors, aim_error
from vision.budget import Budget, ErrorSource
from vision.budget_conditions import Conditions
from vision.ideal_fit import IdealFit

Array = NDArray[np.float64]


_ALL = frozenset(ErrorSource)


@dataclass(frozen=True, slots=True)
class Check:
    """Drawn against linear: ratios of the root mean squares, and shares of the draws within the linear 95 % radii."""

    draws: int
    angle_ratio: float
    position_ratio: float
    angle_within: float
    position_within: float


@dataclass(frozen=True, slots=True)
class SourceCheck:
    """The same ratios of one source alone; None where the source does nothing to the angle or to the position."""

    angle_ratio: float | None
    position_ratio: float | None


def check_budget(conditions: Conditions, budget: Budget, draws: int, seed: int) -> Check:
    """Draw all errors `draws` times and compare.

    Parameters
    ----------
    conditions : Conditions
        Those of the budget.
    budget : Budget
        Linear.
    draws, seed : int
        How many, and where the random numbers start.

    Returns
    -------
    Check
        A ratio's sampling error is below 1 / sqrt(2 draws).
    """
    angle, position = _magnitudes(conditions, _ALL, draws, seed)
    whole, total = budget.whole(), budget.total
    return Check(
        draws=draws,
        angle_ratio=float(np.sqrt((angle**2).mean() / np.trace(total[:3, :3]))),
        position_ratio=float(np.sqrt((position**2).mean() / np.trace(total[3:, 3:]))),
        angle_within=float((angle <= whole.angle_rad).mean()),
        position_within=float((position <= whole.position_mm).mean()),
    )


def check_sources(conditions: Conditions, budget: Budget, draws: int, seed: int) -> dict[ErrorSource, SourceCheck]:
    """Draw each source alone `draws` times; the target's depth is left out, whose effect is a product with others'."""
    checks: dict[ErrorSource, SourceCheck] = {}
    for source in ErrorSource:
        if source is ErrorSource.TARGET_DEPTH:
            continue
        angle, position = _magnitudes(conditions, frozenset({source}), draws, seed)
        covariance = budget.covariances[source]
        checks[source] = SourceCheck(_ratio(angle, covariance[:3, :3]), _ratio(position, covariance[3:, 3:]))
    return checks


def _ratio(drawn: Array, covariance: Array) -> float | None:
    """Root mean square of magnitudes (n,) against that of a covariance (3, 3)."""
    expected = float(np.trace(covariance))
    return float(np.sqrt((drawn**2).mean() / expected)) if expected > 0.0 else None


def _magnitudes(conditions: Conditions, sources: frozenset[ErrorSource], draws: int, seed: int) -> tuple[Array, Array]:
    """Angles (n,), rad, and distances (n,), mm, of worlds drawn in which only some sources err."""
    random, fit = np.random.default_rng(seed), conditions.fit()
    errors = np.array([_drawn(conditions, fit, sources, random) for _ in range(draws)])
    return np.linalg.norm(errors[:, :3], axis=1), np.linalg.norm(errors[:, 3:], axis=1)


def _drawn(
    conditions: Conditions, fit: IdealFit, sources: frozenset[ErrorSource], random: np.random.Generator
) -> Array:
    """The aim's error (6,) of one world drawn: the files' errors are the truth's distance from them."""

    def drawn(source: ErrorSource, *shape: int) -> Array:
        normal = random.normal(size=shape)
        return normal if source in sources else 0.0 * normal

    off = np.zeros(len(fit.gain))
    known = [0, 1, 2, 3, 10, 11, 12]  # the parameters that the files speak of
    by_files = np.concatenate((drawn(ErrorSource.INTRINSICS, 4), drawn(ErrorSource.RING_TOLERANCES, 3)))
    off[known] = np.linalg.solve(fit.prior_rows[:, known], by_files)
    truth, guide = fit.moved(off)
    half = _root(conditions.plate.coefficient_covariance)
    coefficients = half @ drawn(ErrorSource.DISTORTION, len(half), 2)
    noise = conditions.point_sd_px * drawn(ErrorSource.PIXEL_NOISE, len(fit.along))
    measured = fit.measured(truth, guide) + noise + np.einsum("nac,ca->n", fit.bend, coefficients)
    plate, motion = conditions.plate, conditions.motion
    at_target = plate.map.basis(plate.map.raw_from_corrected(conditions.pixel_corrected[None]))[0]
    arm_sd, tcp_sd = np.repeat((motion.arm_rad, motion.arm_mm), 3), np.repeat((motion.tcp_rad, motion.tcp_mm), 3)
    errors = AimErrors(
        pixel_px=at_target @ coefficients,
        tcp=tcp_sd * drawn(ErrorSource.TCP_CALIBRATION, 6),
        arm=arm_sd * drawn(ErrorSource.ARM, 2, 6),
        bore_mm=guide.tolerance.bore_concentricity_sd_mm * drawn(ErrorSource.BORE, 2),
        depth_mm=conditions.depth_sd_mm * float(drawn(ErrorSource.TARGET_DEPTH)),
    )
    return aim_error(truth, fit.solved(measured), errors, guide, conditions.pixel_corrected, conditions.depth_mm)


def _root(covariance: Array) -> Array:
    """A matrix (m, m) whose product with its transpose is a covariance (m, m)."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)))

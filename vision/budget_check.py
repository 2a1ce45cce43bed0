"""The budget checked by Monte Carlo: every source drawn at once, through the projection and the targeting itself."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.aim_error import AimErrors, aim_error
from vision.budget import Budget
from vision.budget_conditions import Conditions
from vision.ideal_fit import IdealFit

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Check:
    """Drawn against linear: ratios of the root mean squares, and shares of the draws within the linear 95 % radii."""

    draws: int
    angle_ratio: float
    position_ratio: float
    angle_within: float
    position_within: float


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
    random, fit = np.random.default_rng(seed), conditions.fit()
    errors = np.array([_drawn(conditions, fit, random) for _ in range(draws)])
    whole, total = budget.whole(), budget.total
    angle, position = np.linalg.norm(errors[:, :3], axis=1), np.linalg.norm(errors[:, 3:], axis=1)
    return Check(
        draws=draws,
        angle_ratio=float(np.sqrt((angle**2).mean() / np.trace(total[:3, :3]))),
        position_ratio=float(np.sqrt((position**2).mean() / np.trace(total[3:, 3:]))),
        angle_within=float((angle <= whole.angle_rad).mean()),
        position_within=float((position <= whole.position_mm).mean()),
    )


def _drawn(conditions: Conditions, fit: IdealFit, random: np.random.Generator) -> Array:
    """The aim's error (6,) of one world drawn: the files' errors are the truth's distance from them."""
    off = np.zeros(len(fit.gain))
    known = [0, 1, 2, 3, 10, 11, 12]  # the parameters that the files speak of
    off[known] = np.linalg.solve(fit.prior_rows[:, known], random.normal(size=len(known)))
    truth, guide = fit.moved(off)
    coefficients = _correlated(conditions.plate.coefficient_covariance, random)
    noise = conditions.point_sd_px * random.normal(size=len(fit.along))
    measured = fit.measured(truth, guide) + noise + np.einsum("nac,ca->n", fit.bend, coefficients)
    plate, motion = conditions.plate, conditions.motion
    at_target = plate.map.basis(plate.map.raw_from_corrected(conditions.pixel_corrected[None]))[0]
    spread = np.array([motion.arm_rad] * 3 + [motion.arm_mm] * 3)
    errors = AimErrors(
        pixel_px=at_target @ coefficients,
        tcp=np.array([motion.tcp_rad] * 3 + [motion.tcp_mm] * 3) * random.normal(size=6),
        arm=spread * random.normal(size=(2, 6)),
        bore_mm=guide.tolerance.bore_concentricity_sd_mm * random.normal(size=2),
        depth_mm=conditions.depth_sd_mm * float(random.normal()),
    )
    return aim_error(truth, fit.solved(measured), errors, guide, conditions.pixel_corrected, conditions.depth_mm)


def _correlated(covariance: Array, random: np.random.Generator) -> Array:
    """Draws (m, 2) with a covariance (m, m), the same for both columns."""
    values, vectors = np.linalg.eigh(covariance)
    return np.asarray(vectors * np.sqrt(np.maximum(values, 0.0)) @ random.normal(size=(len(values), 2)))

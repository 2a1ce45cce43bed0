"""Whether something moved half-way through a calibration: the guide on its flange, or the C-arm against the arm.

Either leaves every pose but little off, since the solution settles between the two halves; what it does not leave is a
cost that hardly falls where some of the poses may differ from the others. So does an arm whose kinematics err, but that
knows nothing of the order in which the poses were recorded.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import chi2

from robot.frames import Array

_FEWEST_ON_A_SIDE = 2
_FALSE_ALARMS = 1e-3  # of whole calibrations in which nothing moved, as far as errors are as they were taken to be
_ORDERS = 200  # among which that of the recording must be the best: 0.5 % of those in which nothing moved
_ROUNDING = 1e-6
_UNTOLD = 1e-8  # of the largest singular value: a direction that nothing tells about


@dataclass(frozen=True, slots=True)
class Apart:
    """Poses, counted from 0, that may have another transform than the others; chi-square falls by `drop`."""

    poses: tuple[int, ...]
    drop: float
    limit: float


@dataclass(frozen=True, slots=True, eq=False)
class Solved:
    """A calibration at its solution.

    Attributes
    ----------
    residuals : (m,), weighted
        Those of the images first, pose by pose.
    jacobian : (m, n)
        Columns at scales that make them alike.
    rows : sequence of int
        How many residuals each image has.
    fixed : sequence of slice
        Columns of each transform that is taken to stay.
    """

    residuals: Array
    jacobian: Array
    rows: Sequence[int]
    fixed: Sequence[slice]


def later_half(solved: Solved) -> Apart | None:
    """The last poses, where they are apart from those before them by more than chance and any other order would tell.

    None where they are not, or where there are too few for two sides.
    """
    known, poses = _orthonormal(solved.jacobian), tuple(range(len(solved.rows)))
    found = _likeliest(solved, known, _later(poses))
    if found is None or found.drop <= found.limit:
        return None
    lots = np.random.default_rng(0)
    others = (_likeliest(solved, known, _later(tuple(lots.permutation(poses)))) for _ in range(_ORDERS))
    # An order with the same two sides, either first, says the same but for rounding.
    return None if any(one is not None and one.drop > found.drop * (1.0 + _ROUNDING) for one in others) else found


def single_pose(solved: Solved) -> Apart | None:
    """The pose that is likeliest apart from all others."""
    return _likeliest(solved, _orthonormal(solved.jacobian), [(pose,) for pose in range(len(solved.rows))])


def _later(order: tuple[int, ...]) -> list[tuple[int, ...]]:
    return [order[place:] for place in range(_FEWEST_ON_A_SIDE, len(order) - _FEWEST_ON_A_SIDE + 1)]


def _likeliest(solved: Solved, known: Array, candidates: Sequence[tuple[int, ...]]) -> Apart | None:
    tried = [(poses, columns) for poses in candidates for columns in solved.fixed]
    apart = (_apart(solved, known, poses, columns, len(tried)) for poses, columns in tried)
    return max(apart, key=lambda one: one.drop, default=None)


def _apart(solved: Solved, known: Array, poses: tuple[int, ...], columns: slice, tried: int) -> Apart:
    """By how much chi-square falls with one more transform for some of the poses, to first order.

    With the residuals r, the jacobian J at the solution and S, its columns of that transform in the rows of those poses
    alone, |P r|^2 with P the projection on what S spans beside J (the score test; Rao 1948). Where the errors are
    larger than they were taken to be, the fall counts by their size.
    """
    whose = np.repeat(np.arange(len(solved.rows)), solved.rows)
    own = np.zeros_like(solved.jacobian[:, columns])
    own[: len(whose)] = np.isin(whose, poses)[:, None] * solved.jacobian[: len(whose), columns]
    beside = _orthonormal(own - known @ (known.T @ own))
    drop, rank = _squares(beside.T @ solved.residuals), beside.shape[1]
    freedom = max(len(solved.residuals) - known.shape[1] - rank, 1)
    error = max((_squares(solved.residuals) - drop) / freedom, 1.0)
    return Apart(poses, drop / error, float(chi2.isf(_FALSE_ALARMS / tried, max(rank, 1))))


def _squares(values: Array) -> float:
    return float(values @ values)


def _orthonormal(columns: Array) -> Array:
    left, sizes, _ = np.linalg.svd(columns, full_matrices=False)
    return np.asarray(left[:, sizes > _UNTOLD * sizes[0]])

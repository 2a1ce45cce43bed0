"""Where the guide is on the flange, from poses of the arm and images of the guide by one fixed C-arm.

Of each image the guide's pose in the source frame is known, with what all images have in common (intrinsics, the
guide's dimensions) and how sure each of these is, all together: a pose along the beam is hardly known by itself, but
with the focal length made one for all images the arm's own motions settle it.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult, least_squares
from scipy.spatial.transform import Rotation

from robot.frames import Array, Transform, check_rigid
from robot.hand_eye_step import Solved, later_half, single_pose
from robot.refusal import Refusal, RefusalCode

FEWEST = 6  # sightings; twelve unknowns at six a sighting need two, the rest averages the arm's errors
# What an arm's pose is off against its others nearby, along and about each axis: a UR5 repeats to 0.1 mm, and its
# nominal kinematics drift by as much between poses some centimetres and degrees apart.
ARM_SD_MM = 0.1
ARM_SD_RAD = 3e-4
# The result is good for nothing beyond these: standard deviations in the worst direction.
_SD_LIMIT_MM = 0.3
_SD_LIMIT_RAD = float(np.deg2rad(0.1))
_UNTOLD = 1e-13  # of the largest information
_OFF_LIMIT_SD = 10.0  # one pose of the arm that is off by more, 1 mm or 0.17 deg, belongs to another image
_GUIDE, _BASE = slice(0, 6), slice(6, 12)  # of the unknowns


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """One pose of the arm and what its image says.

    Attributes
    ----------
    base_from_flange : (4, 4), mm
    source_from_guide : (4, 4), mm
    shared : (k,)
        Estimates of what all images have in common.
    weights : (m, k + 6)
        Of the error d of shared quantities, then of a small rotation vector (rad) and a translation (mm), both in the
        source frame and applied on the left; |weights d - offset|^2 is what the image costs.
    offset : (m,)
    """

    base_from_flange: Transform
    source_from_guide: Transform
    shared: Array
    weights: Array
    offset: Array


@dataclass(frozen=True, slots=True, eq=False)
class SharedPrior:
    """What is known beforehand of the (k,) shared quantities: costs |weights (shared - values)|^2, counted once."""

    values: Array
    weights: Array


@dataclass(frozen=True, slots=True, eq=False)
class HandEye:
    """The calibration.

    Attributes
    ----------
    flange_from_guide, source_from_base : (4, 4), mm
    covariance : (6, 6)
        Of flange_from_guide: small rotation vector (rad) and translation (mm), applied on the right.
    off_mm, off_rad : (n,)
        By how much each pose of the arm was off.
    cost_ratio : float
        Weighted squares over degrees of freedom: about 1 where the errors are as large as they were taken to be.
    """

    flange_from_guide: Transform
    source_from_base: Transform
    covariance: Array
    off_mm: Array
    off_rad: Array
    cost_ratio: float

    @property
    def translation_sd_mm(self) -> float:
        """In the worst direction."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[3:, 3:])[-1]))

    @property
    def rotation_sd_rad(self) -> float:
        """About the worst axis."""
        return float(np.sqrt(np.linalg.eigvalsh(self.covariance[:3, :3])[-1]))


def calibrate(
    sightings: Sequence[Sighting], prior: SharedPrior, start_flange_from_guide: Transform
) -> HandEye | Refusal:
    """Solve source_from_guide = source_from_base base_from_flange flange_from_guide over all sightings.

    Unknown are both fixed transforms, the shared quantities, and by how much each pose of the arm was off.

    Parameters
    ----------
    sightings : sequence of Sighting
        At least six.
    prior : SharedPrior
    start_flange_from_guide : (4, 4), mm
        Within some millimetres and degrees: where to start.

    Raises
    ------
    ValueError
        If a transform is not rigid.
    """
    if len(sightings) < FEWEST:
        return Refusal(RefusalCode.TOO_FEW_POSES, "images of the guide", float(len(sightings)), float(FEWEST))
    problem = _Problem(sightings, prior, check_rigid(start_flange_from_guide))
    solution = least_squares(problem.residuals, problem.start(), method="lm", x_scale=problem.scales())
    found = problem.result(solution)
    return _refuse_inconsistent(problem.solved(solution), found) or _refuse_alike(found) or found


def _refuse_alike(found: HandEye) -> Refusal | None:
    advice = "the poses are too alike: turn the guide by 15 deg and more about two axes, shift it across the image"
    sd_mm, sd_rad = found.translation_sd_mm, found.rotation_sd_rad
    if not sd_mm <= _SD_LIMIT_MM:
        return Refusal(RefusalCode.POSES_TOO_ALIKE, f"{advice} (mm, standard deviation)", sd_mm, _SD_LIMIT_MM)
    if not sd_rad <= _SD_LIMIT_RAD:
        return Refusal(RefusalCode.POSES_TOO_ALIKE, f"{advice} (rad, standard deviation)", sd_rad, _SD_LIMIT_RAD)
    return None


def _refuse_inconsistent(solved: Solved, found: HandEye) -> Refusal | None:
    """By what explains most: some poses are off where something moved, and some may have moved where one is off."""
    off, half = _refuse_off(found), later_half(solved)
    if half is None:
        return off
    alone = single_pose(solved)
    if off is not None and alone is not None and alone.drop >= half.drop:
        return off
    message = (
        f"the guide on its flange, or the C-arm or base, moved behind pose {half.poses[0]}: fasten it and record all"
        " poses anew (fall of chi-square)"
    )
    return Refusal(RefusalCode.POSES_INCONSISTENT, message, half.drop, half.limit)


def _refuse_off(found: HandEye) -> Refusal | None:
    off_sd = np.maximum(found.off_mm / ARM_SD_MM, found.off_rad / ARM_SD_RAD)
    worst = int(off_sd.argmax())
    if off_sd[worst] <= _OFF_LIMIT_SD:
        return None
    message = f"pose {worst + 1} of {len(off_sd)} does not go with its image (standard deviations of the arm)"
    return Refusal(RefusalCode.POSES_INCONSISTENT, message, float(off_sd[worst]), _OFF_LIMIT_SD)


class _Problem:
    """The unknowns in one vector: turn and shift of the guide on the flange, of the base before the source, the shared
    quantities, then turn and shift of each flange."""

    def __init__(self, sightings: Sequence[Sighting], prior: SharedPrior, flange_from_guide: Transform) -> None:
        self._flanges = np.stack([check_rigid(one.base_from_flange) for one in sightings])
        self._seen = np.stack([check_rigid(one.source_from_guide) for one in sightings])
        self._sightings, self._prior = sightings, prior
        self._flange_from_guide = flange_from_guide
        self._source_from_base = _mean_pose(self._seen @ np.linalg.inv(self._flanges @ flange_from_guide))
        self._count = len(prior.values)
        self._arm_sd = np.array([ARM_SD_RAD] * 3 + [ARM_SD_MM] * 3)

    def start(self) -> Array:
        """No correction, the shared quantities at their mean."""
        values = np.zeros(12 + self._count + self._flanges.shape[0] * 6)
        values[12 : 12 + self._count] = np.mean([one.shared for one in self._sightings], axis=0)
        return values

    def scales(self) -> Array:
        """Typical sizes of the unknowns."""
        pose = [1e-3] * 3 + [1.0] * 3
        shared = np.maximum(np.abs(self._prior.values) * 1e-3, 1e-3)
        return np.concatenate([pose, pose, shared, np.tile(self._arm_sd, len(self._sightings))])

    def residuals(self, unknowns: Array) -> Array:
        """Weighted: of the images, of the arm, of the prior."""
        shared, arm = unknowns[12 : 12 + self._count], unknowns[12 + self._count :].reshape(-1, 6)
        predicted = self._base(unknowns) @ self._flanges @ _small(arm) @ self._guide(unknowns)
        turns = Rotation.from_matrix(predicted[:, :3, :3] @ self._seen[:, :3, :3].swapaxes(1, 2)).as_rotvec()
        shifts = predicted[:, :3, 3] - self._seen[:, :3, 3]
        images = [
            one.weights @ np.concatenate([shared - one.shared, turn, shift]) - one.offset
            for one, turn, shift in zip(self._sightings, turns, shifts, strict=True)
        ]
        return np.concatenate(
            [*images, (arm / self._arm_sd).ravel(), self._prior.weights @ (shared - self._prior.values)]
        )

    def result(self, solution: OptimizeResult) -> HandEye:
        """What the solution means."""
        freedom = max(len(solution.fun) - len(solution.x), 1)
        ratio = float(solution.fun @ solution.fun) / freedom
        scaled = solution.jac * self.scales()
        values, vectors = np.linalg.eigh(scaled.T @ scaled)
        # what no pose tells about has no finite variance: pseudo-inverted it would pass for certain
        spread = (vectors / np.maximum(values, _UNTOLD * values[-1])) @ vectors.T
        covariance = spread * np.outer(self.scales(), self.scales())
        arm = solution.x[12 + self._count :].reshape(-1, 6)
        return HandEye(
            flange_from_guide=self._guide(solution.x),
            source_from_base=self._base(solution.x),
            covariance=covariance[:6, :6] * max(ratio, 1.0),
            off_mm=np.linalg.norm(arm[:, 3:], axis=1),
            off_rad=np.linalg.norm(arm[:, :3], axis=1),
            cost_ratio=ratio,
        )

    def solved(self, solution: OptimizeResult) -> Solved:
        """What the solution leaves, for whoever asks whether both transforms stayed."""
        rows = [len(one.weights) for one in self._sightings]
        return Solved(solution.fun, solution.jac * self.scales(), rows, (_GUIDE, _BASE))

    def _guide(self, unknowns: Array) -> Transform:
        return np.asarray(self._flange_from_guide @ _small(unknowns[_GUIDE]))

    def _base(self, unknowns: Array) -> Transform:
        return np.asarray(_small(unknowns[_BASE]) @ self._source_from_base)


def _small(steps: Array) -> Array:
    """Transforms (..., 4, 4) from (..., 6) rotation vectors and translations."""
    poses = np.zeros((*steps.shape[:-1], 4, 4))
    poses[..., :3, :3] = Rotation.from_rotvec(steps[..., :3]).as_matrix()
    poses[..., :3, 3] = steps[..., 3:]
    poses[..., 3, 3] = 1.0
    return poses


def _mean_pose(poses: Array) -> Transform:
    mean = np.eye(4)
    mean[:3, :3] = Rotation.from_matrix(poses[:, :3, :3]).mean().as_matrix()
    mean[:3, 3] = poses[:, :3, 3].mean(axis=0)
    return mean

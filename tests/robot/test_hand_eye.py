"""Hand-eye calibration: exact data, noise, what all images share, and poses that say too little."""

from dataclasses import replace

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robot.frames import distance_between
from robot.hand_eye import HandEye, SharedPrior, Sighting, calibrate
from robot.refusal import Refusal, RefusalCode

NOTHING_SHARED = SharedPrior(np.empty(0), np.empty((0, 0)))


def pose(turn_deg: list[float], shift_mm: list[float]) -> np.ndarray:
    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_rotvec(turn_deg, degrees=True).as_matrix()
    transform[:3, 3] = shift_mm
    return transform


FLANGE_FROM_GUIDE = pose([69.3, -69.3, 69.3], [0.4, -30.2, 150.1])
SOURCE_FROM_BASE = pose([175.0, 10.0, -5.0], [120.0, -300.0, 700.0])
STILL = np.eye(4)
START = FLANGE_FROM_GUIDE @ pose([0.2, -0.1, 0.2], [0.3, -0.3, 0.2])


def arm_poses(count: int, axes: int = 3, seed: int = 3) -> list[np.ndarray]:
    rng = np.random.default_rng(seed)
    turns = rng.uniform(-30.0, 30.0, (count, 3)) * ([1.0] * axes + [0.0] * (3 - axes))
    return [pose(list(turn), list(rng.uniform(-60.0, 60.0, 3) + np.array([300.0, 0.0, 400.0]))) for turn in turns]


def sighted(
    flange: np.ndarray,
    error: np.ndarray | None = None,
    sd_rad: float = 1e-4,
    sd_mm: float = 0.02,
    guide: np.ndarray = STILL,
    base: np.ndarray = STILL,
) -> Sighting:
    """Of the guide moved on its flange, and of the base moved before the source, by so much."""
    seen = base @ SOURCE_FROM_BASE @ flange @ FLANGE_FROM_GUIDE @ guide
    if error is not None:
        seen = seen.copy()
        seen[:3, :3] = Rotation.from_rotvec(error[:3]).as_matrix() @ seen[:3, :3]
        seen[:3, 3] += error[3:]
    weights = np.diag([1.0 / sd_rad] * 3 + [1.0 / sd_mm] * 3)
    return Sighting(flange, seen, np.empty(0), weights, np.zeros(6))


def noisy(flanges: list[np.ndarray], seed: int = 0, **moved: np.ndarray) -> list[Sighting]:
    """Arm and images err as much as they are taken to."""
    rng, sightings = np.random.default_rng(seed), []
    for flange in flanges:
        off = pose(list(np.rad2deg(rng.normal(0.0, 3e-4, 3))), list(rng.normal(0.0, 0.1, 3)))
        image = np.concatenate([rng.normal(0.0, 1e-4, 3), rng.normal(0.0, 0.02, 3)])
        sightings.append(replace(sighted(flange @ off, image, **moved), base_from_flange=flange))
    return sightings


def test_exact_sightings_give_the_exact_mounting_as_the_library_does() -> None:
    flanges = arm_poses(8)
    sightings = [sighted(flange) for flange in flanges]
    found = calibrate(sightings, NOTHING_SHARED, START)
    assert isinstance(found, HandEye)
    assert found.flange_from_guide == pytest.approx(FLANGE_FROM_GUIDE, abs=1e-6)
    assert found.source_from_base == pytest.approx(SOURCE_FROM_BASE, abs=1e-5)
    # OpenCV's camera is our guide carried by the flange, its world our source: A X = Z B from the other end
    guide_from_sources = [np.linalg.inv(one.source_from_guide) for one in sightings]
    flange_from_bases = [np.linalg.inv(flange) for flange in flanges]
    turn, shift = cv2.calibrateRobotWorldHandEye(
        [one[:3, :3] for one in guide_from_sources],
        [one[:3, 3] for one in guide_from_sources],
        [one[:3, :3] for one in flange_from_bases],
        [one[:3, 3] for one in flange_from_bases],
    )[2:]
    library = np.eye(4)
    library[:3, :3], library[:3, 3] = turn, shift.ravel()
    assert np.linalg.inv(library) == pytest.approx(found.flange_from_guide, abs=1e-4)


def test_errors_stay_within_what_the_covariance_says() -> None:
    squares = []
    for seed in range(4):
        found = calibrate(noisy(arm_poses(12, seed=seed), seed=seed), NOTHING_SHARED, START)
        assert isinstance(found, HandEye)
        apart = np.linalg.inv(found.flange_from_guide) @ FLANGE_FROM_GUIDE
        error = np.concatenate([Rotation.from_matrix(apart[:3, :3]).as_rotvec(), apart[:3, 3]])
        squares.append(float(error @ np.linalg.solve(found.covariance, error)))
        assert 0.4 < found.cost_ratio < 1.8
    assert 2.0 < np.mean(squares) < 11.0  # of 6 degrees of freedom, 4 times: sd 1.7


def test_what_all_images_share_is_found_from_the_arms_own_motion() -> None:
    """Every image scales the distance by the same unknown factor, which one image alone cannot tell from a distance."""
    scale, weights = 0.01, np.array([[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]])
    sightings = []
    for flange in arm_poses(12):
        true = SOURCE_FROM_BASE @ flange @ FLANGE_FROM_GUIDE
        seen = true.copy()
        seen[2, 3] *= 1.0 + scale  # as told under shared = 0
        rows = np.zeros((6, 7))
        rows[:3, 1:4] = np.eye(3) * 1e4
        rows[3, 4] = rows[4, 5] = 50.0
        rows[5, 6], rows[5, 0] = 50.0, 50.0 * true[2, 3]
        sightings.append(Sighting(flange, seen, np.zeros(1), rows, np.zeros(6)))
    found = calibrate(sightings, SharedPrior(np.zeros(1), weights[:, :1]), START)
    assert isinstance(found, HandEye)
    offset_mm, angle_rad = distance_between(found.flange_from_guide, FLANGE_FROM_GUIDE)
    assert offset_mm < 0.02
    assert angle_rad < 1e-4


@pytest.mark.parametrize("axes", [0, 1])
def test_poses_that_turn_about_one_axis_or_none_are_refused_with_the_sd_that_is_left(axes: int) -> None:
    refusal = calibrate([sighted(flange) for flange in arm_poses(12, axes)], NOTHING_SHARED, START)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.POSES_TOO_ALIKE
    assert "15 deg" in refusal.message
    assert refusal.measured > refusal.limit


def test_too_few_poses_are_refused() -> None:
    refusal = calibrate([sighted(flange) for flange in arm_poses(5)], NOTHING_SHARED, START)
    assert isinstance(refusal, Refusal)
    assert (refusal.code, refusal.measured) == (RefusalCode.TOO_FEW_POSES, 5.0)


def test_pose_of_another_image_is_named() -> None:
    flanges = arm_poses(12)
    sightings = [sighted(flange) for flange in flanges]
    sightings[4] = replace(sightings[4], base_from_flange=flanges[4] @ pose([0.0] * 3, [0.0, 4.0, 0.0]))
    refusal = calibrate(sightings, NOTHING_SHARED, START)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.POSES_INCONSISTENT
    assert "pose 5 of 12" in refusal.message


@pytest.mark.hazard("H10")
@pytest.mark.parametrize("behind", [3, 6, 9])
@pytest.mark.parametrize("turn_deg", [0.0, 0.3])
@pytest.mark.parametrize("moved", ["guide", "base"])
def test_what_moves_half_way_is_told_with_its_place(moved: str, turn_deg: float, behind: int) -> None:
    """Each pose by itself is hardly off, and the covariance knows nothing of it."""
    step, flanges = pose([turn_deg, 0.0, 0.0], [0.0, 0.5, 0.3]), arm_poses(12)
    sightings = noisy(flanges[:behind]) + noisy(flanges[behind:], **{moved: step}, seed=1)
    refusal = calibrate(sightings, NOTHING_SHARED, START)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.POSES_INCONSISTENT
    assert f"moved behind pose {behind}:" in refusal.message
    assert refusal.measured > refusal.limit


def test_errors_as_large_as_they_are_taken_to_be_are_no_step() -> None:
    for seed in range(20):
        assert isinstance(calibrate(noisy(arm_poses(8, seed=seed), seed=seed), NOTHING_SHARED, START), HandEye)


def test_transform_that_is_not_rigid_is_the_callers_mistake() -> None:
    sightings = [sighted(flange) for flange in arm_poses(6)]
    sightings[0] = replace(sightings[0], base_from_flange=2.0 * np.eye(4))
    with pytest.raises(ValueError, match="transform"):
        calibrate(sightings, NOTHING_SHARED, START)

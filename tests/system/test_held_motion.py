"""A held motion through service and guard to a controller, and every way that it ends."""

import numpy as np
import pytest

from service.client import Case


def _approach(case: Case, lift_mm: float = 20.0) -> dict:
    pose = np.array(case.status()["arm"]["base_from_tcp"])
    # The parked guide points straight down: half a turn about x, as its rotation vector.
    vector_deg = np.rad2deg(_rotation_vector(pose[:3, :3]))
    goal = {"translation_mm": list(pose[:3, 3] + [0.0, 0.0, lift_mm]), "rotation_vector_deg": list(vector_deg)}
    return case.plan("approach", base_from_goal=goal)


def _rotation_vector(rotation: np.ndarray) -> np.ndarray:
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(rotation).as_rotvec()


def test_an_approved_and_held_approach_arrives(case: Case) -> None:
    plan = _approach(case)
    assert plan["detail"]["length_mm"] == pytest.approx(20.0, abs=0.01)
    with case.hold(case.approve(plan, "2468")) as hold:
        ended = hold.wait(30.0)
    assert ended.cause == "arrived"
    assert ended.distance_mm < 0.1
    assert case.status()["state"] == "case_open"

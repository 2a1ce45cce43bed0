"""The way to a goal as a plan's answer tells it: piece by piece, what each comes nearest to; or why there is none."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coaxial_client import Case, Refused
from tests.system.conftest import DEVICES

_AWAY_MM = 60.0  # the lamp, from the centre of the guide's small ring
_HALF_MM = 20.0  # of its edges
_FOREMOST = ("guide", "holder")  # parts of the arm that point to it


def _ahead(case: Case, forward_mm: float) -> np.ndarray:
    """(4, 4), mm: where the guide would be further along its own axis."""
    pose = np.array(case.status()["arm"]["base_from_tcp"])
    pose[:3, 3] += forward_mm * pose[:3, 2]
    return pose


def _plan(case: Case, base_from_goal: np.ndarray) -> dict:
    vector_deg = np.rad2deg(Rotation.from_matrix(base_from_goal[:3, :3]).as_rotvec())
    goal = {"translation_mm": list(base_from_goal[:3, 3]), "rotation_vector_deg": list(vector_deg)}
    return case.plan("approach", base_from_goal=goal)["detail"]


def _refused(case: Case, base_from_goal: np.ndarray) -> Refused:
    with pytest.raises(Refused) as caught:
        _plan(case, base_from_goal)
    assert caught.value.what_to_do
    assert case.status()["chain"]["plan"] is None
    return caught.value


@pytest.fixture(scope="module")
def lamp(room, controller) -> None:
    """A room file with a lamp in front of the guide, for every case that is opened next."""
    base_from_tcp = controller.state().base_from_flange_nominal @ controller.state().flange_from_tcp
    centre = base_from_tcp[:3, 3] + base_from_tcp[:3, 2] * (_AWAY_MM + _HALF_MM)
    box = f'\n[[box]]\nname = "lamp"\noccupant = "other"\ncentre_mm = {list(map(float, centre))}\n'
    edges = f"size_mm = [{2 * _HALF_MM}, {2 * _HALF_MM}, {2 * _HALF_MM}]\n"
    room.upload_device("room", DEVICES["room"].replace(b'version = "1"', b'version = "2"') + (box + edges).encode())


@pytest.mark.hazard("H12")
def test_a_plan_tells_each_piece_of_its_way_and_what_that_comes_nearest_to(lamp, case) -> None:
    goal = _ahead(case, 15.0)
    start = np.array(case.status()["arm"]["base_from_tcp"])[:3, 3]
    plan = _plan(case, goal)
    ends = np.array([piece["to_mm"] for piece in plan["preview"]])
    assert ends[-1] == pytest.approx(goal[:3, 3], abs=1e-3)
    along_mm = (ends - start) @ goal[:3, 2]
    assert (np.diff(along_mm, prepend=0.0) > 0.0).all(), "the pieces follow one another"
    assert np.linalg.norm(ends - start - np.outer(along_mm, goal[:3, 2]), axis=1).max() < 1e-3, "on one line"
    assert plan["preview"][-1]["shape"] == "lamp"
    assert plan["preview"][-1]["part"] in _FOREMOST
    clearances_mm = np.array([piece["clearance_mm"] for piece in plan["preview"]])
    assert plan["clearance_mm"] == pytest.approx(clearances_mm.min())
    assert clearances_mm[-1] < _AWAY_MM - 15.0  # of the small ring's centre, which is not the arm's foremost point
    nearer_mm, gone_mm = clearances_mm[0] - clearances_mm[-1], along_mm[-1] - along_mm[0]
    assert nearer_mm == pytest.approx(gone_mm, abs=1.0)


@pytest.mark.hazard("H12")
def test_a_way_into_a_shape_is_refused_with_piece_part_shape_and_how_near(lamp, case) -> None:
    refused = _refused(case, _ahead(case, _AWAY_MM + _HALF_MM))
    assert refused.code == "keep_out"
    assert any(part in refused.detail for part in _FOREMOST)
    for said in ("lamp", "between samples", "mm along the line"):
        assert said in refused.detail
    assert refused.measured < 0.0
    assert refused.limit == 5.0  # the room file's clearance


@pytest.mark.hazard("H11")
def test_a_goal_out_of_reach_is_no_plan(case) -> None:
    goal = np.diag([1.0, -1.0, -1.0, 1.0])
    goal[:3, 3] = 700.0
    refused = _refused(case, goal)
    assert refused.code in {"goal_unreachable", "path_too_long"}
    assert refused.measured > refused.limit
    attempt = case.attempts()[0]
    assert attempt["code"] == refused.code
    [verdict] = attempt["verdicts"]
    assert verdict["hazard"] in {"H11", "H12"}
    assert (verdict["passed"], verdict["measured"], verdict["limit"]) == (False, refused.measured, refused.limit)

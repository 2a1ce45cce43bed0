"""What the guard compares, at its limit and a last bit beyond it."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from robot.arm import ArmState
from robot.frames import distance_between
from robot.guard import deviation, motion, preflight, rest
from robot.guard.deviation import PathWatch, has_kept_tcp
from robot.guard.messages import BeginMove, EndCause
from robot.guard.motion import MotionJudge, is_at
from robot.guard.preflight import refuse_arm, refuse_payload, refuse_tcp
from robot.guard.rest import DisplacementWatch, RestWatch
from robot.kinematics import base_from_flange

TURN = np.eye(4)
TURN[:3, :3] = Rotation.from_euler("z", 2.0, degrees=True).as_matrix()
STEP = np.eye(4)
STEP[0, 3] = 0.5


def below(figure: float) -> float:
    return float(np.nextafter(figure, 0.0))


@pytest.mark.hazard("H10")
def test_a_tcp_may_differ_as_far_as_its_tolerance(move: BeginMove) -> None:
    turned_rad = distance_between(np.eye(4), TURN)[1]
    for tcp, name, figure in ((STEP, "tcp_tolerance_mm", 0.5), (TURN, "tcp_tolerance_rad", turned_rad)):
        assert refuse_tcp(replace(move, **{name: figure}), tcp) is None
        assert refuse_tcp(replace(move, **{name: below(figure)}), tcp) is not None


@pytest.mark.hazard("H10")
def test_a_payload_may_differ_as_far_as_its_tolerance(move: BeginMove, reading: ArmState) -> None:
    heavy = replace(reading, payload_kg=1.5)
    leaning = replace(reading, payload_centre_mm=reading.payload_centre_mm + np.array([3.0, 4.0, 0.0]))
    for other, name, figure in ((heavy, "payload_tolerance_kg", 0.5), (leaning, "payload_tolerance_mm", 5.0)):
        assert refuse_payload(replace(move, **{name: figure}), other) is None
        assert refuse_payload(replace(move, **{name: below(figure)}), other) is not None


@pytest.mark.hazard("H12")
@pytest.mark.parametrize("index", [0, 1], ids=["way", "turn"])
def test_a_goal_may_be_as_far_as_the_cap(
    move: BeginMove, reading: ArmState, monkeypatch: pytest.MonkeyPatch, index: int
) -> None:
    further = replace(move, base_from_goal=reading.base_from_tcp @ (STEP, TURN)[index])
    name, slack = (("LENGTH_CAP_MM", "DISTURBED_MM"), ("ANGLE_CAP_RAD", "DISTURBED_RAD"))[index]
    figure = distance_between(reading.base_from_tcp, further.base_from_goal)[index]
    monkeypatch.setattr(preflight, slack, 0.0)
    monkeypatch.setattr(preflight, name, figure)
    assert refuse_arm(further, reading) is None
    monkeypatch.setattr(preflight, name, below(figure))
    assert refuse_arm(further, reading) is not None


@pytest.mark.hazard("H04")
@pytest.mark.parametrize("name", ["DISTURBED_MM", "DISTURBED_RAD", "_WINDING_RAD"])
def test_an_arm_may_stand_off_its_permit_as_far_as_counts_for_nothing(
    move: BeginMove, reading: ArmState, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    moved = replace(reading, joints_rad=reading.joints_rad + 0.25 * np.eye(6)[2])
    places = [base_from_flange(one.joints_rad) @ move.flange_from_guide for one in (reading, moved)]
    offset_mm, angle_rad = distance_between(*places)
    winding_rad = float(np.abs(moved.joints_rad - reading.joints_rad).max())
    figures = {"DISTURBED_MM": offset_mm, "DISTURBED_RAD": angle_rad, "_WINDING_RAD": winding_rad}
    for other, figure in figures.items():
        monkeypatch.setattr(preflight, other, figure if other == name else 1e3)
    assert refuse_arm(move, moved) is None
    monkeypatch.setattr(preflight, name, below(figures[name]))
    assert refuse_arm(move, moved) is not None


@pytest.mark.hazard("H10")
@pytest.mark.parametrize(("index", "name"), [(0, "tcp_tolerance_mm"), (1, "tcp_tolerance_rad")])
def test_a_tcp_is_the_same_as_far_as_its_tolerance(move: BeginMove, reading: ArmState, index: int, name: str) -> None:
    other = replace(reading, base_from_tcp=reading.base_from_tcp @ (STEP, TURN)[index])
    flange = base_from_flange(reading.joints_rad)
    implied = [np.linalg.solve(flange, one.base_from_tcp) for one in (reading, other)]
    figure = distance_between(*implied)[index]
    tolerant = replace(move, tcp_tolerance_mm=9.0, tcp_tolerance_rad=9.0)
    assert has_kept_tcp(replace(tolerant, **{name: figure}), reading, other)
    assert not has_kept_tcp(replace(tolerant, **{name: below(figure)}), reading, other)


@pytest.mark.hazard("H12")
@pytest.mark.parametrize(("aside", "name"), [(STEP, "OFF_PATH_MM"), (TURN, "OFF_PATH_RAD")])
def test_a_line_is_as_wide_as_its_limit(
    move: BeginMove, reading: ArmState, monkeypatch: pytest.MonkeyPatch, aside: np.ndarray, name: str
) -> None:
    start, goal = replace(reading, base_from_tcp=np.eye(4)), np.eye(4)
    goal[1, 3] = 10.0
    away = replace(reading, base_from_tcp=aside)
    figure = 0.5 if name == "OFF_PATH_MM" else 2.0 * distance_between(np.eye(4), aside)[1]  # there and back
    for limit, off in ((figure, False), (below(figure), True)):
        monkeypatch.setattr(deviation, name, limit)
        watch = PathWatch(replace(move, base_from_goal=goal), start)
        assert [watch.is_off(away) for _ in range(3)] == [False, False, off]


@pytest.mark.parametrize(("aside", "name"), [(STEP, "_REST_DRIFT_MM"), (TURN, "_REST_DRIFT_RAD")])
def test_a_rest_goes_on_as_far_as_its_drift(
    reading: ArmState, monkeypatch: pytest.MonkeyPatch, aside: np.ndarray, name: str
) -> None:
    before = replace(reading, base_from_tcp=np.eye(4))
    after = replace(reading, base_from_tcp=aside, received_at_s=1.0)
    figure = distance_between(np.eye(4), aside)[0 if name == "_REST_DRIFT_MM" else 1]
    for limit, rested_s in ((figure, 1.0), (below(figure), 0.0)):
        monkeypatch.setattr(rest, name, limit)
        watch = RestWatch()
        watch.observe(before)
        assert watch.observe(after) == rested_s


@pytest.mark.parametrize(("aside", "name"), [(STEP, "ARRIVAL_MM"), (TURN, "ARRIVAL_RAD")])
def test_a_goal_is_reached_as_near_as_its_limit(
    move: BeginMove, reading: ArmState, monkeypatch: pytest.MonkeyPatch, aside: np.ndarray, name: str
) -> None:
    here = replace(reading, base_from_tcp=np.eye(4))
    figure = distance_between(np.eye(4), aside)[0 if name == "ARRIVAL_MM" else 1]
    for limit, reached in ((figure, True), (below(figure), False)):
        monkeypatch.setattr(motion, name, limit)
        assert is_at(here, replace(move, base_from_goal=aside)) is reached


@pytest.mark.parametrize(("aside", "name"), [(STEP, "DISTURBED_MM"), (TURN, "DISTURBED_RAD")])
def test_an_arm_has_left_its_place_beyond_what_counts_for_nothing(
    move: BeginMove, reading: ArmState, monkeypatch: pytest.MonkeyPatch, aside: np.ndarray, name: str
) -> None:
    start = replace(reading, base_from_tcp=np.eye(4))
    late = replace(reading, base_from_tcp=aside, received_at_s=1.0, program_running=True)
    figure = distance_between(np.eye(4), aside)[0 if name == "DISTURBED_MM" else 1]
    for limit, cause in ((figure, EndCause.NOT_STARTED), (below(figure), None)):
        monkeypatch.setattr(motion, name, limit)
        assert MotionJudge(move, start, np.zeros(3), 0.0).judge(late) is cause


@pytest.mark.hazard("H04")
@pytest.mark.parametrize(("aside", "name"), [(STEP, "DISTURBED_MM"), (TURN, "DISTURBED_RAD")])
def test_a_displacement_counts_beyond_its_limit_and_is_told_when_it_is_gathered(
    reading: ArmState, monkeypatch: pytest.MonkeyPatch, aside: np.ndarray, name: str
) -> None:
    monkeypatch.setattr(rest, "_GATHERED_S", 0.5)
    figure = distance_between(np.eye(4), aside)[0 if name == "DISTURBED_MM" else 1]
    for limit, told in ((figure, False), (below(figure), True)):
        monkeypatch.setattr(rest, name, limit)
        watch = DisplacementWatch()
        watch.observe(replace(reading, base_from_tcp=np.eye(4)))
        away = [replace(reading, base_from_tcp=aside, received_at_s=time_s) for time_s in (1.0, 1.25, 1.5)]
        assert [watch.observe(one) is not None for one in away] == [False, False, told]

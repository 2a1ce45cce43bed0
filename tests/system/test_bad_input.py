"""What a room gets wrong: each is refused with a code and what to do, is remembered, and changes no state."""

import numpy as np
import pytest

from coaxial_client import Refused
from simulator.controller import PowerAction
from tests.system.service_process import PIN

_MOVE_COMMANDS = (1, 2, 3, 4)  # of the control program: joints, pose, straight line, straight line to joints


def _refused(call) -> Refused:
    with pytest.raises(Refused) as caught:
        call()
    assert 400 <= caught.value.status < 500
    assert caught.value.what_to_do
    return caught.value


def _failed(refused: Refused) -> set[str]:
    return {verdict["code"] for verdict in refused.verdicts if not verdict["passed"]}


@pytest.fixture
def exposed(walk):
    """A case that waits for an image."""
    walk.carm_positioned()
    walk.case.command("exposure-requested")
    return walk


def _arrives_unused(walk, until, status: int, expected: int, verdict: str) -> None:
    """The image was answered so, is recorded with its verdicts, and has not entered the chain."""
    assert status == expected
    until(lambda: verdict in _failed_of_newest_image(walk.case))
    after = walk.case.status()
    assert after["state"] == "carm_positioned"
    assert after["chain"]["image"] is None
    assert after["images"] >= 1


def _failed_of_newest_image(case) -> set[str]:
    attempts = [one for one in case.attempts() if one["trigger"] == "image_arrived"]
    return {one["code"] for one in attempts[0]["verdicts"] if not one["passed"]} if attempts else set()


@pytest.mark.hazard("H01")
def test_another_patients_image_enters_no_chain(exposed, until) -> None:
    status = exposed.carm.expose(exposed.source_from_guide, PatientID="P2")
    _arrives_unused(exposed, until, status, 0x0000, "patient_matches")


@pytest.mark.hazard("H01")
def test_an_image_of_another_study_enters_no_chain(exposed, until) -> None:
    status = exposed.carm.expose(exposed.source_from_guide, StudyInstanceUID="1.2.4")
    _arrives_unused(exposed, until, status, 0x0000, "study_matches")


@pytest.mark.hazard("H02")
def test_an_image_that_came_before_enters_no_chain(exposed, until) -> None:
    image = exposed.carm.image(exposed.source_from_guide)
    exposed.carm.send(image)
    exposed.case.wait_for("registered", timeout_s=90)
    exposed.case.command("retake", reason="once more")
    exposed.case.command("exposure-requested")
    again = exposed.carm.sent_again(image)
    _arrives_unused(exposed, until, exposed.carm.send(again), 0x0000, "pixels_unseen")


@pytest.mark.hazard("H31")
def test_an_image_cut_short_is_answered_as_not_understood_and_enters_no_chain(exposed, until) -> None:
    image = exposed.carm.image(exposed.source_from_guide)
    image.PixelData = image.PixelData[:1000]
    _arrives_unused(exposed, until, exposed.carm.send(image), 0xC000, "image_unseen")


def test_an_image_of_one_pixel_is_answered_as_not_understood_and_enters_no_chain(exposed, until) -> None:
    image = exposed.carm.image(exposed.source_from_guide, Rows=1, Columns=1, PixelData=bytes(2))
    _arrives_unused(exposed, until, exposed.carm.send(image), 0xC000, "image_unseen")


def test_an_image_that_nobody_asked_for_is_counted(case, carm, walk, until) -> None:
    before = case.status()
    carm.expose(walk.source_from_guide)
    until(lambda: case.status()["images"] == before["images"] + 1)
    after = case.status()
    assert (after["state"], after["version"]) == (before["state"], before["version"])


def test_an_image_without_a_guide_is_refused_with_what_was_found(exposed, until) -> None:
    behind = exposed.source_from_guide.copy()
    behind[0, 3] = 600.0
    exposed.carm.expose(behind)
    until(lambda: "registration_refused" in {event["trigger"] for event in exposed.case.record()}, 90.0)
    refusal = next(event for event in exposed.case.record() if event["trigger"] == "registration_refused")
    assert refusal["data"]["reason"]["code"]
    assert exposed.case.status()["state"] == "carm_positioned"


@pytest.mark.hazard("H04")
def test_an_arm_jogged_after_the_image_voids_it(walk, controller, until) -> None:
    walk.to("registered")
    controller.push(np.array([0.1, 0.0, 0.0]))
    until(lambda: walk.case.status()["state"] == "carm_positioned")
    assert "arm_disturbed" in {event["trigger"] for event in walk.case.record()}


@pytest.mark.hazard("H08")
def test_a_target_outside_the_image_in_another_image_or_never_drawn_back_is_refused(walk) -> None:
    status, case = walk.to("registered"), walk.case
    image = status["chain"]["image"]
    assert _refused(lambda: case.echo(image, (4000.0, 500.0))).code == "target_outside_image"
    assert _refused(lambda: case.echo("another", (500.0, 500.0))).code == "image_not_registered"
    assert _failed(_refused(lambda: case.command("target-confirmed", echo_id="none"))) >= {"target_echo"}
    echo = case.echo(image, (560.0, 470.0))
    unknown = _refused(lambda: case.command("target-confirmed", echo_id=echo["echo_id"], planned_target="L9"))
    assert unknown.code == "planned_target_unknown"
    assert case.status()["state"] == "registered"


@pytest.mark.hazard("H13")
def test_a_permit_that_was_never_given_moves_nothing(case, controller) -> None:
    before = controller.state().joints_rad
    _refused(lambda: case.hold("no-such-permit").__enter__())
    assert np.array_equal(before, controller.state().joints_rad)


@pytest.fixture
def shifted_tcp(case, controller, until):
    """Shift the controller's TCP setting by so many mm, which the guard sees as a displaced arm."""
    right = controller.state().flange_from_tcp

    def displaced() -> int:
        return sum(event["trigger"] == "arm_disturbed" for event in case.record())

    def set_tcp(flange_from_tcp: np.ndarray) -> None:
        before = displaced()
        controller.set_tcp(flange_from_tcp)
        until(lambda: displaced() > before)  # else the next plan, or the next case, would be met by it

    def shift(offset_mm: float) -> None:
        wrong = right.copy()
        wrong[0, 3] += offset_mm
        set_tcp(wrong)

    yield shift
    set_tcp(right)


@pytest.mark.hazard("H10")
def test_a_grossly_wrong_tcp_is_no_plan(lift, shifted_tcp) -> None:
    shifted_tcp(6.0)
    refused = _refused(lambda: lift(10.0))
    assert refused.code == "model_mismatch"
    assert refused.measured > refused.limit


@pytest.mark.hazard("H10")
def test_a_tcp_that_is_off_by_2_mm_is_refused_by_the_guard_before_anything_moves(
    case, lift, shifted_tcp, controller
) -> None:
    """Nominal kinematics cannot tell 2 mm from a calibrated arm, so the plan is approved: the guard reads the TCP."""
    shifted_tcp(2.0)
    before, joints = controller.wire()[-1].number, controller.state().joints_rad
    with case.hold(case.approve(lift(10.0), PIN)) as hold:
        ended = hold.wait(20.0)
    assert (ended.cause, ended.problem["code"]) == ("refused", "tcp_mismatch")
    assert ended.problem["measured"] == pytest.approx(2.0, abs=0.01)
    assert ended.problem["measured"] > ended.problem["limit"]
    assert ended.problem["what_to_do"]
    assert _moves(controller, before) == []
    assert np.array_equal(joints, controller.state().joints_rad)


def _moves(controller, after: int) -> list[str]:
    """Moves that reached the controller since."""
    return [one.text for one in controller.wire(after) if one.command in _MOVE_COMMANDS]


def test_an_arm_that_is_off_is_told_and_approved_for_no_motion(case, lift, controller, until) -> None:
    plan = lift(10.0)
    controller.power(PowerAction.OFF)
    try:
        held = case.wait_for("safe_hold")
        assert held["held_for"] == "arm_off"
        assert _refused(lambda: case.approve(plan, PIN)).code == "held"
    finally:
        controller.release()
        until(lambda: case.status()["arm"]["safety"] == "normal")

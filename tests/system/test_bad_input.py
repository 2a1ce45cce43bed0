"""What a room gets wrong: each is refused with a code and what to do, is remembered, and changes no state."""

import numpy as np
import pytest
from pydicom.uid import generate_uid

from service.client import Refused
from simulator.controller import PowerAction

PIN = "2468"


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


def test_another_patients_image_enters_no_chain(exposed, until) -> None:
    status = exposed.carm.expose(exposed.source_from_guide, PatientID="P2")
    _arrives_unused(exposed, until, status, 0x0000, "patient_matches")


def test_an_image_of_another_study_enters_no_chain(exposed, until) -> None:
    status = exposed.carm.expose(exposed.source_from_guide, StudyInstanceUID="1.2.4")
    _arrives_unused(exposed, until, status, 0x0000, "study_matches")


def test_an_image_that_came_before_enters_no_chain(exposed, until) -> None:
    image = exposed.carm.image(exposed.source_from_guide)
    exposed.carm.send(image)
    exposed.case.wait_for("registered", timeout_s=90)
    exposed.case.command("retake", reason="once more")
    exposed.case.command("exposure-requested")
    image.SOPInstanceUID = image.file_meta.MediaStorageSOPInstanceUID = generate_uid()
    image.AcquisitionTime = exposed.carm.next_time()
    _arrives_unused(exposed, until, exposed.carm.send(image), 0x0000, "pixels_unseen")


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


def test_an_arm_jogged_after_the_image_voids_it(walk, controller, until) -> None:
    walk.to("registered")
    controller.push(np.array([0.1, 0.0, 0.0]))
    until(lambda: walk.case.status()["state"] == "carm_positioned")
    assert "arm_disturbed" in {event["trigger"] for event in walk.case.record()}


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


def test_a_goal_out_of_reach_is_no_plan(case) -> None:
    goal = {"translation_mm": [700.0, 700.0, 700.0], "rotation_vector_deg": [180.0, 0.0, 0.0]}
    refused = _refused(lambda: case.plan("approach", base_from_goal=goal))
    assert refused.code in {"goal_unreachable", "path_too_long"}
    assert refused.measured > refused.limit
    assert case.attempts()[0]["code"] == refused.code
    assert case.status()["chain"]["plan"] is None


def test_a_permit_that_was_never_given_moves_nothing(case, controller) -> None:
    before = controller.state().joints_rad
    _refused(lambda: case.hold("no-such-permit").__enter__())
    assert np.array_equal(before, controller.state().joints_rad)


def test_a_tool_that_is_not_the_calibrated_one_is_approved_for_no_motion(case, lift, controller) -> None:
    right = controller.state().flange_from_tcp
    wrong = right.copy()
    wrong[0, 3] += 2.0
    controller.set_tcp(wrong)
    try:
        refused = _refused(lambda: case.approve(lift(10.0), PIN))
        assert "tcp_mm" in _failed(refused)
    finally:
        controller.set_tcp(right)


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

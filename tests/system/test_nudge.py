"""A guide without a bead: a nudge between two images proves handedness; and an old image, overridden with a reason."""

import numpy as np
import pytest

from coaxial_client import Refused
from simulator.carm.guide import ALL_PARTS, GuideShape, Part
from tests.system.carm import CArm
from tests.system.conftest import CASE, DEVICES, prepare
from tests.system.service_process import PIN
from tests.waiting import until

_REFERENCE = DEVICES["guide"]
_BARE = _REFERENCE[: _REFERENCE.index(b"[bead]")] + _REFERENCE[_REFERENCE.index(b"[tolerance]") :]
_WHY = {"image_age": "nobody touched the C-arm"}


@pytest.fixture(scope="module")
def service(start_service, controller):
    """Images are old at once, and the arm is known well."""
    limits = {"COAXIAL_LIMITS__IMAGE_AGE_S": "0.1", "COAXIAL_ARM_ACCURACY__POSITION_SD_MM": "0.1"}
    return start_service(controller.address, **limits)


@pytest.fixture
def case(service, controller):
    with service.sign_in() as room:
        for kind, content in (DEVICES | {"guide": _BARE.replace(b"reference-guide", b"bare-guide")}).items():
            room.upload_device(kind, content)
        opened = prepare(room.open_case(CASE))
        yield opened
        opened.command("case-aborted", reason="end of the test")


@pytest.fixture
def carm(service):
    bare = CArm(service, str(CASE["patient_id"]), str(CASE["study_uid"]))
    bare.shape = GuideShape(parts=ALL_PARTS - {Part.BEAD})
    return bare


def _refusal(ask) -> Refused:
    with pytest.raises(Refused) as caught:
        ask()
    return caught.value


def _move(case, make_plan, **overrides) -> None:
    """Held until it arrives; a crowded machine may lose the hold, and then it goes on by a plan of its own."""
    for _ in range(4):
        with case.hold(case.approve(make_plan(), PIN, **overrides)) as hold:
            cause = hold.wait(60.0).cause
        if case.status()["state"] != "safe_hold":
            assert cause == "arrived"
            return
        until(lambda: case.status()["arm"]["connected"])
        case.command("acknowledged", guide="empty")
    pytest.fail("the machine is too busy to hold a button")


def _arm(case) -> np.ndarray:
    return np.array(case.status()["arm"]["base_from_tcp"])


def _of(case, trigger: str) -> dict:
    return next(event for event in reversed(case.record()) if event["trigger"] == trigger)["data"]


def _nudged_and_registered(case, walk, carm) -> None:
    walk.carm_positioned()
    case.command("exposure-requested")
    carm.expose(walk.source_from_guide)
    until(lambda: any(event["trigger"] == "registration_refused" for event in case.record()), 60.0)
    assert _of(case, "registration_refused")["reason"]["code"] == "handedness_unproved"
    case.status()
    along_x = {"translation_mm": [10.0, 0.0, 0.0]}
    assert _refusal(lambda: case.plan("nudge", step=along_x)).code == "nudge_too_short"
    case.status()
    before = _arm(case)
    _move(case, lambda: case.plan("nudge", step={"translation_mm": [0.0, 8.0, 0.0]}))
    walk.source_from_guide = walk.source_from_guide @ np.linalg.inv(before) @ _arm(case)
    case.command("exposure-requested")
    carm.expose(walk.source_from_guide)
    case.wait_for("registered", timeout_s=60.0)


def _overridden_target(case, walk) -> None:
    reasons = case.status()["allowed"]["target_confirmed"]["reasons"]
    assert [(one["code"], one["limit"], one["hard_limit"], one["overridable"]) for one in reasons] == [
        ("image_age", 0.1, 3600.0, True)
    ]
    echo = case.echo(case.status()["chain"]["image"], walk.target_px)
    confirm = {"echo_id": echo["echo_id"], "planned_target": "L3 left"}
    refused = _refusal(lambda: case.command("target-confirmed", **confirm))
    assert [one["code"] for one in refused.verdicts if one["overridable"]] == ["image_age"]
    never = {"target_echo": "I saw it"}
    assert _refusal(lambda: case.command("target-confirmed", **confirm, overrides=never)).code == "not_overridable"
    case.command("target-confirmed", **confirm, overrides=_WHY)


@pytest.mark.timeout(300)
def test_a_nudge_proves_handedness_and_an_old_image_moves_the_arm_only_with_a_reason(case, walk, carm) -> None:
    _nudged_and_registered(case, walk, carm)
    proof = _of(case, "registration_completed")["nudge"]
    assert proof["nudge_mm"] > 7.9
    assert proof["mirrored_chi_square"] > proof["chi_square"] + 40.0
    _overridden_target(case, walk)
    assert _refusal(lambda: case.plan("targeting")).code == "interlock"
    plan = case.plan("targeting", overrides=_WHY)
    assert _refusal(lambda: case.approve(plan, PIN)).code == "interlock"
    _move(case, lambda: case.plan("targeting", overrides=_WHY), overrides=_WHY)
    assert case.status()["state"] == "moved"
    assert _of(case, "move_approved")["overrides"] == _WHY
    started = next(one for one in case.attempts() if one["trigger"] == "move_started")
    age = next(verdict for verdict in started["verdicts"] if verdict["code"] == "image_age")
    assert age["passed"]
    assert _WHY["image_age"] in age["message"]

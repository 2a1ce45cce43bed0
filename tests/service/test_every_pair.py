"""Every state x every trigger over HTTP: taken as the table says, or refused, typed, remembered and without effect.

The room has no arm, so that what needs one is refused by an interlock. The cases are put into their states by
recording them there; what is expected comes from the second table, which is written independently of the rules.
"""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any
from uuid import uuid4

import numpy as np
import pytest

from coaxial_client import Case, Coaxial, Refused
from service.auth.lease import take_lease
from service.auth.permissions import Role
from service.cases import store
from service.cases.attempts import list_attempts
from service.cases.records import ArtefactKind, NewArtefact, NewEvent
from service.errors import ANSWERS, ErrorCode
from tests.workflow.conftest import Walk
from tests.workflow.test_table import CELLS, chain_after, insertion, letters, prepare, refusal_of, settled
from workflow.case import CaseState
from workflow.case_json import from_json, to_json
from workflow.refusals import RefusalCode
from workflow.states import OVER, State
from workflow.triggers import Kind, Trigger

_PIN = "2468"
_REASON = {"reason": "because"}
_MOVED = {"what": "something moved"}
# What comes with each request or fact; those of an observation or without a body are not here.
_BODIES: dict[Trigger, Callable[[CaseState], dict[str, Any]]] = {
    Trigger.NEWEST_IMAGE_REUSED: lambda case: {"image_id": case.newest_image_id or "none"},
    Trigger.RETAKE: lambda _: _REASON,
    Trigger.TARGET_CONFIRMED: lambda _: {"echo_id": "none"},
    Trigger.TARGET_WITHDRAWN: lambda _: _REASON,
    Trigger.PLAN_REQUESTED: lambda _: {"kind": "retreat", "distance_mm": 20.0},
    Trigger.MOVE_APPROVED: lambda case: {"plan_id": case.plan.id if case.plan else "none", "pin": _PIN},
    Trigger.CORRECTION_REQUESTED: lambda _: _REASON,
    Trigger.VERIFICATION_REJECTED: lambda _: _REASON,
    Trigger.INSERTION_STARTED: lambda _: {"pin": _PIN},
    Trigger.TARGET_DONE: lambda _: {"placed": True},
    Trigger.GUIDE_STATE_STATED: lambda _: {"guide": "empty"},
    Trigger.CARM_MOVED: lambda _: _MOVED,
    Trigger.PATIENT_MOVED: lambda _: _MOVED,
    Trigger.HAND_GUIDED: lambda _: _MOVED,
    Trigger.DEVICE_CHANGED: lambda _: _MOVED,
    Trigger.HOLD_REQUESTED: lambda _: _REASON,
    Trigger.ACKNOWLEDGED: lambda case: {"guide": case.guide},
    Trigger.LEASE_TAKEN: lambda _: _REASON,
    Trigger.CASE_CLOSED: lambda _: {"pin": _PIN},
    Trigger.CASE_ABORTED: lambda _: _REASON,
    Trigger.NOTE: lambda _: {"text": "a remark"},
    Trigger.LABEL: lambda case: {"image_id": case.newest_image_id or "none", "label": "scout"},
}


# Not a POST of its own: status and export are read, and a motion starts with the held button.
_READ = {Trigger.READ: "status", Trigger.EXPORT: "export"}


# What a listed request is refused for in this room: without an arm, an image, or the end of every target.
_LACKING = {
    Trigger.CARM_POSITION_CONFIRMED: "interlock",
    Trigger.EXPOSURE_REQUESTED: "interlock",
    Trigger.NEWEST_IMAGE_REUSED: "interlock",
    Trigger.TARGET_CONFIRMED: "interlock",
    Trigger.PLAN_REQUESTED: "arm_unknown",
    Trigger.MOVE_APPROVED: "interlock",
    Trigger.MOVE_STARTED: "interlock",
    Trigger.INSERTION_STARTED: "interlock",
    Trigger.ACKNOWLEDGED: "interlock",
    Trigger.CASE_CLOSED: "targets_open",
    Trigger.LABEL: "image_unknown",
}


class NamedApart(Walk):
    """The usual case, with ids that no other has."""

    def new_id(self, what: str) -> str:
        return f"{what}-{uuid4().hex}"


class Room:
    """A service without an arm, its surgeon signed in and in control of its open case."""

    def __init__(self, running: Any, surgeon: Coaxial) -> None:
        self.parts = running.parts
        self.surgeon = surgeon
        self.case = self._open_case()
        self.session = running.parts.sessions.find(self.case._transport.token)

    def _open_case(self) -> Case:
        target = {"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}
        return self.surgeon.open_case({"patient_id": "P1", "study_uid": "1.2.3", "targets": [target]})

    def _is_over(self) -> bool:
        with self.parts.database.read() as connection:
            return store.open_case_of(connection, self.parts.settings.room) is None

    def put(self, case: CaseState) -> CaseState:
        """A case recorded to stand like this: one that was over stays so."""
        if case.state not in OVER and self._is_over():
            self.case = self._open_case()
        case = replace(case, case_id=self.case.id)
        event = NewEvent("note", self.session.user_id, case.state, to_json(case), {})
        made = tuple(artefacts_of(case, self.session.user_id))
        with self.parts.database.write() as connection:
            stored = store.append(connection, case.case_id, event, expected_version=None, artefacts=made)
            self.case.control_token = take_lease(connection, case.case_id, self.session, "test").fencing_token
        self.case.version = stored.version
        return case

    def stands(self) -> CaseState:
        with self.parts.database.read() as connection:
            return from_json(dict(store.newest_event(connection, self.case.id).case_state))

    def remembers(self) -> tuple[str, bool, str, str]:
        """The newest attempt of the case."""
        with self.parts.database.read() as connection:
            (newest,) = list_attempts(connection, self.case.id, limit=1)
        return newest["trigger"], newest["accepted"], newest["code"], newest["state"]

    def send(self, trigger: Trigger, case: CaseState) -> None:
        """The trigger as a client sends it; Refused where it is."""
        if trigger in _READ:
            self.case._transport.request("GET", f"/cases/{case.case_id}/{_READ[trigger]}")
        elif trigger is Trigger.STOP:
            self.case.stop()
        elif trigger is Trigger.MOVE_STARTED:
            with self.case.hold("no-such-permit"):
                raise AssertionError("a motion started without a permit")
        else:
            body = _BODIES.get(trigger, lambda _: {})(case)
            self.case.command(trigger.replace("_", "-"), **body)


def artefacts_of(case: CaseState, user_id: str) -> Iterator[NewArtefact]:
    """What the routes read of a case before they ask the rules."""
    if case.plan is not None:
        content = {"kind": case.plan.kind, "base_from_goal": np.eye(4).tolist(), "detectable_motion": None}
        content |= {"start_joints_rad": [0.0] * 6, "speed_mm_s": 20.0, "acceleration_mm_s2": 50.0, "duration_s": 1.0}
        yield NewArtefact(ArtefactKind.PLAN, case.plan.id, (), content, {})
    if case.permit is not None:
        yield NewArtefact(ArtefactKind.PERMIT, case.permit.id, (), {"plan_id": case.plan.id}, {"approved_by": user_id})
    if case.insertion is not None:
        yield NewArtefact(ArtefactKind.INSERTION, case.insertion.id, (), {"planned_target": None}, {})


@pytest.fixture(scope="module")
def room(running, device_files) -> Iterator[Room]:
    with Coaxial(running.url) as client:
        client.sign_in(Role.SURGEON.value, "correct horse")
        for kind, content in device_files.items():
            client.upload_device(kind, content.encode())
        yield Room(running, client)


def expected_refusal(case: CaseState, trigger: Trigger) -> str | None:
    """The code of the refusal in this room; None where the trigger is taken."""
    if trigger.kind is Kind.OBSERVATION:
        return ErrorCode.UNKNOWN_PATH  # nobody tells the service what only it observes
    if trigger is Trigger.CORRECTION_REQUESTED and case.verification is not None and case.target is not None:
        return ErrorCode.ARTEFACT_UNKNOWN  # the figures of the evaluation are read before the rules are asked
    if (case.state.value, trigger.value) in CELLS:
        return _LACKING.get(trigger)
    return refusal_of(case, trigger) if trigger.kind is Kind.REQUEST else None


def check_refused(room: Room, before: CaseState, trigger: Trigger, refused: Refused, expected: str) -> None:
    assert (refused.code, refused.status) == (expected, ANSWERS[expected].status), (before.state, trigger)
    assert room.stands() == before
    if trigger.kind is Kind.REQUEST and expected in set(RefusalCode):
        assert room.remembers() == (trigger, False, expected, before.state)
        assert refused.leads_onwards or before.state in OVER


def check_taken(room: Room, before: CaseState, trigger: Trigger) -> None:
    listed = CELLS.get((before.state.value, trigger.value))
    after = room.stands().state
    if listed is None or listed.to == "same":
        assert after is before.state, trigger
        return
    passed = before.verification is not None and before.verification.passed
    slots = dict(effect.split("=") for effect in listed.effects if "=" in effect)
    chain = chain_after(letters(before), listed.effects, passed)
    settles_to = settled(chain, passed, slots.get("S", insertion(before)))
    assert after.value == (settles_to if listed.to == "settle" else listed.to), trigger


@pytest.mark.parametrize("state", State)
def test_every_trigger_is_taken_as_the_table_says_or_refused_without_effect(room, state):
    for trigger in Trigger:
        before = room.put(prepare(NamedApart(), state, trigger))
        expected = expected_refusal(before, trigger)
        if expected is None:
            room.send(trigger, before)
            check_taken(room, before, trigger)
        else:
            with pytest.raises(Refused) as caught:
                room.send(trigger, before)
            check_refused(room, before, trigger, caught.value, expected)

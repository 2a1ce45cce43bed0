"""A case of the service in any state: recorded there, and driven over HTTP as a client drives it."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from typing import Any
from uuid import uuid4

import numpy as np

from coaxial_client import Case, Coaxial
from service.auth.lease import take_lease
from service.cases import store
from service.cases.attempts import list_attempts
from service.cases.records import ArtefactKind, NewArtefact, NewEvent
from tests.workflow.conftest import Walk
from workflow.case import CaseState
from workflow.case_json import from_json, to_json
from workflow.states import OVER
from workflow.triggers import Trigger

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


class NamedApart(Walk):
    """The usual case, with ids that no other has."""

    def new_id(self, what: str) -> str:
        return f"{what}-{uuid4().hex}"


class Room:
    """A service, its surgeon signed in and in control of its open case."""

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

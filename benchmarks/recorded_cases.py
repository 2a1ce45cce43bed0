"""Cases as a procedure records them, without a room; only states and people are left out.

What image work and path check make of two images is given; `computed_results` has it made.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
from sqlalchemy.engine import Connection

from service.auth.permissions import Role
from service.auth.session import Session, SessionStatus
from service.cases import store
from service.cases.opening import CaseToOpen, open_case
from service.cases.records import ArtefactKind, NewArtefact, NewEvent
from service.conductor.image_flow import evaluation_of, registration_artefact
from service.conductor.targets import target_artefact
from service.database.engines import Database
from service.devices.store import DeviceKind, add_device
from service.images.dicom_header import read_header
from service.images.store import NewPurpose, add_image, assign_purpose
from service.ledger.draft import describe
from service.settings import Settings
from workflow.case import CaseState, opened
from workflow.case_json import to_json
from workflow.links import Artefact
from workflow.states import State

_DEVICES = Path(__file__).parents[1] / "tests" / "devices"
DEVICES = {
    DeviceKind.GUIDE: (_DEVICES / "guide.toml").read_bytes(),
    DeviceKind.CARM: (_DEVICES / "flat-panel.toml").read_bytes(),
    DeviceKind.TCP: (_DEVICES / "tcp.toml").read_bytes(),
    DeviceKind.ROOM: (_DEVICES / "room.toml").read_bytes(),
}
PATIENT, STUDY = "P1", "1.2.3"
_CASE = {
    "patient_id": PATIENT,
    "study_uid": STUDY,
    "targets": [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}],
}
DEPTH_MM = 80.0  # of the picked point


@dataclass(frozen=True)
class Results:
    """What image work and path check made of two exposures around one motion."""

    images: tuple[bytes, bytes]
    poses: tuple[np.ndarray, np.ndarray]  # base_from_tcp (4, 4), mm, of each exposure
    registration: Mapping[str, Any]
    targeting: Mapping[str, Any]
    plan: Mapping[str, Any]
    lift: Mapping[str, Any]
    evaluation: dict[str, Any]


def record(database: Database, settings: Settings, user_id: str, results: Results, state: State) -> str:
    """Record a case that went so far, and is in `state` now; its id."""
    recording = Recording(settings, user_id, results, state)
    for step in recording.steps():
        with database.write() as connection:
            step(connection)
    return recording.case.case_id


Step = Callable[[Connection], None]


class Recording:
    """A case that is being recorded, transaction by transaction."""

    def __init__(self, settings: Settings, user_id: str, results: Results, state: State) -> None:
        self.case: CaseState
        self._settings = settings
        self._user_id = user_id
        self._results = results
        self._state = state
        self._image_id = ""  # of the image recorded last

    def steps(self) -> Iterator[Step]:
        """Each in a transaction of its own, before the next is asked for; one that failed may be taken again."""
        first, second = zip(self._results.images, self._results.poses, strict=True)
        yield self._devices
        yield self._open
        yield partial(self._image, *first)
        registration = registration_artefact(uuid4().hex, self._image_id, dict(self._results.registration))
        yield from self._to_the_plan(self._image_id, registration)
        yield partial(self._image, *second)
        evaluated = evaluation_of(self._image_id, dict(self._results.evaluation))
        yield self._event("image_arrived", {"image_id": self._image_id})
        yield self._event("verification_passed", evaluated.data, *evaluated.artefacts)
        yield self._ending

    def _to_the_plan(self, image_id: str, registration: NewArtefact) -> Iterator[Step]:
        target = target_artefact(uuid4().hex, image_id, registration.id, self._results.targeting, DEPTH_MM, "L3 left")
        made_from = (uuid4().hex, image_id, registration.id, target.id)
        plan = NewArtefact(ArtefactKind.PLAN, uuid4().hex, made_from, self._results.plan, {})
        lift = NewArtefact(ArtefactKind.PLAN, uuid4().hex, (), self._results.lift, {})
        yield self._event("image_arrived", {"image_id": image_id})
        yield self._event("registration_completed", {"image_id": image_id}, registration)
        yield self._event("target_confirmed", {}, target)
        self.case = replace(self.case, target=Artefact(target.id, target.made_from))
        yield self._event("plan_requested", {}, plan)
        yield self._event("plan_requested", {}, lift)

    def _devices(self, connection: Connection) -> None:
        for kind, content in DEVICES.items():
            add_device(connection, kind, content, self._user_id)

    def _open(self, connection: Connection) -> None:
        session = Session("none", self._user_id, "none", Role.SURGEON, SessionStatus.ACTIVE, math.inf)
        told = open_case(connection, CaseToOpen.model_validate(_CASE), session, self._settings)
        self.case = opened(told.case_id)

    def _image(self, content: bytes, base_from_tcp: np.ndarray, connection: Connection) -> None:
        header, problem = read_header(content, Settings().dicom)
        self._image_id = add_image(connection, content, header, problem, {"calling_ae": "CARM"}).id
        arm = {"base_from_tcp": base_from_tcp.tolist()}
        assign_purpose(connection, NewPurpose(self._image_id, self.case.case_id, "registration", arm, ()))

    def _event(self, trigger: str, data: Mapping[str, Any], *artefacts: NewArtefact) -> Step:
        def append(connection: Connection) -> None:
            event = NewEvent(trigger, self._user_id, self.case.state, to_json(self.case), {"told_as": trigger, **data})
            store.append(connection, self.case.case_id, event, expected_version=None, artefacts=artefacts)

        return append

    def _ending(self, connection: Connection) -> None:
        self.case = replace(self.case, state=self._state)
        self._event("case_closed" if self._state is State.CLOSED else "note", {})(connection)
        if self._state is State.CLOSED:
            describe(connection, checkpoint="case_closed")

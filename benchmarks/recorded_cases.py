"""Cases as a procedure records them, without a room: two rendered images, and what the service makes of them.

The results come from the service's own image work and path check; only states and people are left out.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from datetime import datetime
from functools import partial
from io import BytesIO
from pathlib import Path
from typing import Any
from uuid import uuid4

import numpy as np
from scipy.spatial.transform import Rotation
from sqlalchemy.engine import Connection

from robot.frames import motion_between
from robot.kinematics import base_from_flange
from robot.path import Way, plan_path
from robot.path_limits import PathLimits
from robot.room_shapes import read_room
from robot.tool import read_tool
from service import vision_jobs
from service.auth.permissions import Role
from service.auth.session import Session, SessionStatus
from service.cases import store
from service.cases.opening import CaseToOpen, open_case
from service.cases.records import ArtefactKind, NewArtefact, NewEvent
from service.conductor.bodies import RequestPlan
from service.conductor.goals import goal_asked_for, goal_at_target
from service.conductor.image_flow import evaluation_of, registration_artefact
from service.conductor.plan_content import plan_content
from service.conductor.targets import target_artefact
from service.database.engines import Database
from service.devices.store import DeviceKind, add_device
from service.images.dicom_header import read_header
from service.images.store import NewPurpose, add_image, assign_purpose
from service.ledger.draft import describe
from service.motion_errors import motion_errors
from service.settings import Settings
from simulator.carm.anatomy import Body
from simulator.carm.camera import Camera
from simulator.carm.dicom import Frame, Worklist, xa_image
from simulator.carm.geometry import Angles
from simulator.carm.guide import GuideShape
from simulator.carm.quick_render import render_quickly
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from simulator.carm.solids import Shape, Solid
from workflow.case import CaseState, opened
from workflow.case_json import to_json
from workflow.links import Artefact
from workflow.plans import PlanKind
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
_PARKED_RAD = np.deg2rad([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])
_TARGET_PX, _DEPTH_MM = (560.0, 470.0), 80.0
_CAMERA = Camera(source_to_image_mm=1000.0, pixel_mm=360.0 / 1024, principal_u_px=514.0, principal_v_px=508.0)
_BONES = tuple(
    Solid(Shape.ELLIPSOID, (x, y, 0.0), (9.0, 6.0, 12.0), 0.03)
    for x, y in ((-38.0, -22.0), (-14.0, 31.0), (4.0, -29.0), (21.0, 12.0), (44.0, -8.0), (-33.0, 9.0), (52.0, 34.0))
)


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


def compute(settings: Settings) -> Results:
    """One target: registered, planned, moved onto, verified."""
    guide, carm = DEVICES[DeviceKind.GUIDE], DEVICES[DeviceKind.CARM]
    tool = read_tool(DEVICES[DeviceKind.TCP])
    errors = motion_errors(settings.arm_accuracy, tool)
    start, source_from_guide = base_from_flange(_PARKED_RAD) @ tool.flange_from_guide, _tilted_guide()
    first = _image(source_from_guide, 1)
    registration = vision_jobs.register(first, guide, carm)
    targeting = vision_jobs.target(registration, _TARGET_PX, _DEPTH_MM, errors)
    plan = _plan(PlanKind.TARGETING, goal_at_target(start, targeting), start)
    wanted = RequestPlan.model_validate({"kind": "retreat", "distance_mm": 40.0})
    lift = _plan(wanted.kind, goal_asked_for(wanted, start), start)
    goal = np.array(plan["base_from_goal"])
    second = _image(source_from_guide @ np.array(targeting["guide_from_goal"]), 2)
    moved = motion_between(start, goal).tolist()
    before = {
        "image": first,
        "registration": registration,
        "before_from_after": moved,
        "errors": errors,
        "handedness_proved": False,
    }
    evaluation = vision_jobs.evaluate(second, guide, carm, _TARGET_PX, _DEPTH_MM, before)
    asked = {"requested": wanted.model_dump(mode="json", exclude_none=True)}
    return Results((first, second), (start, goal), registration, targeting, plan, lift | asked, evaluation)


def _plan(kind: PlanKind, goal: Any, start: np.ndarray) -> dict[str, Any]:
    way = Way(_PARKED_RAD, start, goal.base_from_goal, leaving=goal.axial)
    path = plan_path(way, read_tool(DEVICES[DeviceKind.TCP]), read_room(DEVICES[DeviceKind.ROOM]), PathLimits())
    return plan_content(kind, goal, start, path)


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
        target = target_artefact(uuid4().hex, image_id, registration.id, self._results.targeting, _DEPTH_MM, "L3 left")
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


def _tilted_guide() -> np.ndarray:
    """source_from_guide of a guide 750 mm from the source, tilted by 8 deg: a plain view of it."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xy", [8.0, -3.0], degrees=True).as_matrix()
    pose[:3, 3] = [10.0, -5.0, 750.0]
    return pose


def _image(source_from_guide: np.ndarray, number: int) -> bytes:
    patient = np.eye(4)
    patient[:3, 3] = (0.0, 0.0, 590.0)
    scene = Scene(
        _CAMERA,
        (PlacedGuide(GuideShape(), source_from_guide),),
        (500.0, 500.0),
        intensifier=False,
        body=Body(bone=_BONES, soft=(), bone_textures=(), soft_textures=()),
        source_from_patient=patient,
        exposure=Exposure(bits=16),
    )
    frame = Frame(
        pixels=np.asarray(render_quickly(scene, seed=number).pixels, dtype=np.uint16),
        angles=Angles(math.pi, 0.0),
        source_to_image_mm=1000.0,
        source_to_patient_mm=700.0,
        pixel_mm=_CAMERA.pixel_mm,
        field_of_view_mm=360.0,
        round_field=False,
        number=number,
        at=datetime(2026, 1, 5, 12, 0, number),
        dose_share=1.0,
    )
    file = BytesIO()
    xa_image(frame, Worklist.of(PATIENT, "Doe^Jane", STUDY)).save_as(file, enforce_file_format=True)
    return file.getvalue()

"""Targets: device files, and what a tablet or a planning program sends as JSON."""

import json
from collections.abc import Callable
from pathlib import Path

from fastapi.exceptions import RequestValidationError
from pydantic import BaseModel, ValidationError

from benchmarks.fuzz.mutation import WORDS, changes_of_text
from benchmarks.fuzz.target import Input, Outcome
from robot.errors import MessageError
from robot.guard.lines import decode_command, decode_event
from service.auth.router import SignIn, Unlock
from service.cases.opening import CaseToOpen
from service.conductor import bodies
from service.devices.store import DeviceKind, parse_device
from service.errors import ServiceError
from service.problem_json import answer_malformed
from service.slicer.markups import planned_targets_from

_DEVICES = Path(__file__).parents[2] / "tests" / "devices"
_FILES = {"guide": "guide.toml", "carm": "flat-panel.toml", "tcp": "tcp.toml", "room": "room.toml"}
_LINE = {"label": "entry", "position": [1.0, 2.0, 3.0], "positionStatus": "defined"}
_MARKUPS = {
    "markups": [
        {"type": "Line", "name": "L3", "coordinateSystem": "LPS", "coordinateUnits": "mm"}
        | {"controlPoints": [_LINE, _LINE | {"label": "target", "position": [1.0, 2.0, 43.0]}]}
    ]
}
_POSE = {"translation_mm": [1.0, 2.0, 3.0], "rotation_vector_deg": [0.0, 0.0, 90.0]}
_PLANNED = {"name": "L3", "entry_mm": [0.0, 0.0, 0.0], "target_mm": [0.0, 40.0, 0.0]}
_BODIES: tuple[tuple[type[BaseModel], dict[str, object]], ...] = (
    (CaseToOpen, {"patient_id": "P1", "study_uid": "1.2.3", "position": "prone", "targets": [_PLANNED], "devices": {}}),
    (SignIn, {"name": "anna", "pin": "2468"}),
    (Unlock, {"pin": "2468"}),
    (bodies.ConfirmTarget, {"echo_id": "e", "planned_target": "L3", "depth_mm": 60.0, "overrides": {"fresh": "seen"}}),
    (bodies.ImagePoint, {"image_id": "i", "pixel_px": [1.5, 2.5], "space": "raw"}),
    (bodies.RequestPlan, {"kind": "approach", "base_from_goal": _POSE}),
    (bodies.RequestPlan, {"kind": "nudge", "step": _POSE}),
    (bodies.RequestPlan, {"kind": "retreat", "distance_mm": 30.0}),
    (bodies.ApproveMove, {"plan_id": "p", "pin": "2468", "overrides": {}}),
    (bodies.StateIdentity, {"image_id": "i", "patient_id": "P1", "view_id": None, "purpose": "scout"}),
    (bodies.ChangeDevices, {"what": "new", "devices": {"guide": "x"}}),
    (bodies.CloseCase, {"pin": "2468", "abandoned": {"L3": "no time"}}),
    (bodies.StateGuide, {"guide": "empty"}),
    (bodies.WriteNote, {"text": "a remark"}),
)
_LINES = (
    b'{"type":"heartbeat","permit_id":"p","number":3,"challenge":"c","held":true}',
    b'{"type":"stop","reason":"asked"}',
    b'{"type":"release_pendant","reason":"access"}',
    b'{"type":"acknowledge"}',
    b'{"type":"fault","kind":"guard_lost","at_s":1.0,"message":"gone"}',
    b'{"type":"disturbed","at_s":1.0,"offset_mm":0.07,"angle_rad":0.0}',
)


def device_files() -> list[Input]:
    """The four kinds of TOML file; what is taken can be stored."""
    files = {kind: (_DEVICES / name).read_bytes() for kind, name in _FILES.items()}
    changes = changes_of_text(WORDS, list(files.values()))
    return [Input(file, changes, _device_reader(DeviceKind(kind))) for kind, file in files.items()]


def json_documents() -> list[Input]:
    """Bodies of commands, a plan of 3D Slicer's, and the lines between service and guard."""
    contents = [(json.dumps(content).encode(), _body_reader(kind)) for kind, content in _BODIES]
    contents.append((json.dumps(_MARKUPS).encode(), _read_markups))
    contents += [(line, _read_line) for line in _LINES]
    changes = changes_of_text(WORDS, [content for content, _ in contents])
    return [Input(content, changes, read) for content, read in contents]


def _device_reader(kind: DeviceKind) -> Callable[[bytes], Outcome]:
    def read(data: bytes) -> Outcome:
        try:
            device = parse_device(kind, data)
        except ServiceError as refusal:
            if "\n" in refusal.message:
                raise ValueError("a refusal of more than one line") from refusal
            return f"{kind}: {refusal.code}"
        assert "\x00" not in f"{device.name} {device.version}".encode().decode()
        return f"{kind}: taken"

    return read


def _body_reader(kind: type[BaseModel]) -> Callable[[bytes], Outcome]:
    """As the web framework reads a body; a refusal is written as its answer would be."""

    def read(data: bytes) -> Outcome:
        try:
            content = json.loads(data)
        except (ValueError, RecursionError):
            return "body: no JSON"
        try:
            kind.model_validate(content)
        except ValidationError as error:
            answer = answer_malformed(RequestValidationError(error.errors()))
            return f"body: {json.loads(answer.body)['code']}"
        return "body: taken"

    return read


def _read_markups(data: bytes) -> Outcome:
    try:
        planned_targets_from(data)
    except ServiceError as refusal:
        return f"markups: {refusal.code}"
    return "markups: taken"


def _read_line(data: bytes) -> Outcome:
    for decode in (decode_command, decode_event):
        try:
            return f"line: {type(decode(data)).__name__}"
        except MessageError:
            continue
    return "line: guard_message_invalid"

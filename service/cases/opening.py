"""Opening a case: patient and study, the device files it is bound to, the planned targets."""

import math
from datetime import UTC, datetime
from uuid import uuid4

from pydantic import BaseModel, ConfigDict, Field, field_validator
from sqlalchemy.engine import Connection

import workflow.case
import workflow.case_json
from service.auth.session import Session
from service.cases import store
from service.cases.records import NewCase, NewEvent, StoredEvent
from service.devices.store import DeviceKind, StoredDevice, expired, newest_device, read_device
from service.errors import ErrorCode, ServiceError
from service.images.store import keep_bytes
from service.settings import Settings

Point = tuple[float, float, float]
# H09: points of a plan lie within a patient; a plan in metres or micrometres has none there.
_LARGEST_COORDINATE_MM = 2000.0
_SHORTEST_PATH_MM = 5.0


class PlannedTarget(BaseModel):
    """A planned needle path in patient coordinates (DICOM LPS, mm)."""

    model_config = ConfigDict(extra="forbid")
    name: str = Field(min_length=1, max_length=64)
    entry_mm: Point
    target_mm: Point

    @field_validator("entry_mm", "target_mm")
    @classmethod
    def _plausible(cls, point: Point) -> Point:
        if not all(math.isfinite(value) and abs(value) <= _LARGEST_COORDINATE_MM for value in point):
            raise ValueError(f"coordinates must be finite and within {_LARGEST_COORDINATE_MM:g} mm")
        return point


class CaseToOpen(BaseModel):
    """What a case is opened with; `devices` names files by kind, the newest of each where it does not."""

    model_config = ConfigDict(extra="forbid")
    patient_id: str = Field(min_length=1, max_length=64)
    study_uid: str = Field(pattern=r"^[0-9]+(\.[0-9]+)*$", max_length=64)
    position: str = Field(default="prone", pattern="^(prone|supine)$")
    targets: list[PlannedTarget] = Field(min_length=1, max_length=32)
    devices: dict[DeviceKind, str] = {}

    @field_validator("targets")
    @classmethod
    def _distinct(cls, targets: list[PlannedTarget]) -> list[PlannedTarget]:
        if len({target.name for target in targets}) < len(targets):
            raise ValueError("targets must have different names")
        for target in targets:
            if math.dist(target.entry_mm, target.target_mm) < _SHORTEST_PATH_MM:
                raise ValueError(f"entry and target of {target.name} must be {_SHORTEST_PATH_MM:g} mm apart")
        return targets


def open_case(connection: Connection, wanted: CaseToOpen, session: Session, settings: Settings) -> StoredEvent:
    """Record the case and its first event; ServiceError CASE_OPEN, DEVICE_UNKNOWN or DEVICE_EXPIRED."""
    case_id = uuid4().hex
    devices = {kind: _device(connection, kind, wanted.devices.get(kind)) for kind in DeviceKind}
    case = NewCase(
        id=case_id,
        room=settings.room,
        patient_id=wanted.patient_id,
        study_uid=wanted.study_uid,
        opened_by=session.user_id,
        settings_sha256=keep_bytes(connection, settings.decisive()),  # kept, so that a replay has them
        devices={kind: device.id for kind, device in devices.items()},
        planned_targets={target.name: target.model_dump() | {"position": wanted.position} for target in wanted.targets},
    )
    state = workflow.case.opened(case_id)
    event = NewEvent(
        trigger="case_opened",
        user_id=session.user_id,
        state=state.state,
        case_state=workflow.case_json.to_json(state),
        data={"devices": {kind: device.sha256 for kind, device in devices.items()}},
    )
    return store.open_case(connection, case, event)


def _device(connection: Connection, kind: DeviceKind, device_id: str | None) -> StoredDevice:
    device = newest_device(connection, kind) if device_id is None else read_device(connection, device_id)
    if device.kind is not kind:
        raise ServiceError(ErrorCode.DEVICE_UNKNOWN, f"device file {device.id} is no {kind} file")
    if expired(device, datetime.now(UTC).date()):
        raise ServiceError(
            ErrorCode.DEVICE_EXPIRED, f"{kind} {device.name} {device.version} expired on {device.expires}"
        )
    return device

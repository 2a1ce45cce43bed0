"""The device files that a case uses now: those it was opened with, or those that replaced them since."""

import hashlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from datetime import UTC, datetime
from functools import lru_cache
from typing import TypeVar

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from robot.room_shapes import RoomShapes, read_room
from robot.tool import Tool, read_tool
from service.cases.store import read_case
from service.database import tables
from service.devices.store import DeviceKind, expired, files_with_bytes
from service.errors import ErrorCode, ServiceError
from workflow.triggers import Trigger

_File = TypeVar("_File", Tool, RoomShapes)
_CHANGES = (
    sa.select(tables.events.c.data)
    .where(tables.events.c.case_id == sa.bindparam("case_id"), tables.events.c.trigger == Trigger.DEVICE_CHANGED)
    .order_by(tables.events.c.sequence)
)


@dataclass(frozen=True, slots=True, eq=False)
class DeviceSet:
    """Guide and C-arm as bytes for the image worker, TCP calibration and room read; one hash over all.

    A case that was opened before rooms had files has none, and no path can be checked in it.
    """

    guide: bytes
    carm: bytes
    tool: Tool
    room: RoomShapes | None
    sha256: str
    bytes_sha256: str  # the same, of the bytes as they were read just now
    in_date: bool


def device_ids(connection: Connection, case_id: str) -> dict[str, str]:
    """Ids of the device files that a case uses now, by kind; ServiceError CASE_UNKNOWN."""
    return changed_devices(connection, case_id, read_case(connection, case_id).devices)


def changed_devices(connection: Connection, case_id: str, opened: Mapping[str, str]) -> dict[str, str]:
    """The same, where those that the case was opened with are known."""
    chosen = dict(opened)
    for data in connection.execute(_CHANGES, {"case_id": case_id}).scalars():
        chosen |= data.get("devices", {})
    return chosen


def read_devices(connection: Connection, ids: Mapping[str, str]) -> DeviceSet:
    """The files; ServiceError DEVICE_UNKNOWN, DEVICE_REFUSED where one cannot be read (any more)."""
    today = datetime.now(UTC).date()
    chosen = {kind: ids[kind] for kind in DeviceKind if kind in ids}
    found = files_with_bytes(connection, chosen.values())
    for kind, device_id in chosen.items():
        if found[device_id][0].kind is not kind:
            raise ServiceError(ErrorCode.DEVICE_UNKNOWN, f"device file {device_id} is no {kind} file")
    files = {kind: found[device_id][0] for kind, device_id in chosen.items()}
    contents = {kind: found[device_id][1] for kind, device_id in chosen.items()}
    return DeviceSet(
        guide=contents[DeviceKind.GUIDE],
        carm=contents[DeviceKind.CARM],
        tool=_read(_tool, DeviceKind.TCP, contents),
        room=_read(_room, DeviceKind.ROOM, contents) if DeviceKind.ROOM in contents else None,
        sha256=_joint_hash(file.sha256 for file in files.values()),
        bytes_sha256=_joint_hash(hashlib.sha256(content).hexdigest() for content in contents.values()),
        in_date=not any(expired(file, today) for file in files.values()),
    )


def devices_of(connection: Connection, case_id: str) -> DeviceSet:
    """The files that a case uses now."""
    return read_devices(connection, device_ids(connection, case_id))


def _joint_hash(hashes: Iterable[str]) -> str:
    return hashlib.sha256(" ".join(hashes).encode()).hexdigest()


def _read(reader: Callable[[bytes], _File], kind: DeviceKind, contents: Mapping[DeviceKind, bytes]) -> _File:
    """A file that was readable when it was stored; today's program may be stricter."""
    try:
        return reader(contents[kind])
    except ValueError as error:
        raise ServiceError(ErrorCode.DEVICE_REFUSED, f"the case's {kind} file: {error}") from error


@lru_cache(maxsize=16)
def _tool(content: bytes) -> Tool:
    return read_tool(content)


@lru_cache(maxsize=16)
def _room(content: bytes) -> RoomShapes:
    return read_room(content)

"""Device files as uploaded: versioned, hashed, and held to what their readers find plausible (H09, H10)."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from datetime import date
from enum import StrEnum
from typing import Any, Protocol
from uuid import uuid4

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.database.clock import now_utc
from service.errors import ErrorCode, ServiceError
from service.ledger.draft import describe
from service.ledger.rows import add_rows


class DeviceKind(StrEnum):
    """What a file describes."""

    GUIDE = "guide"
    CARM = "carm"
    TCP = "tcp"
    ROOM = "room"


class DeviceFile(Protocol):
    """What the readers of `vision` and `robot` have in common."""

    @property
    def name(self) -> str: ...
    @property
    def version(self) -> int | str: ...
    @property
    def sha256(self) -> str: ...
    @property
    def expires(self) -> date | None: ...


@dataclass(frozen=True, slots=True)
class StoredDevice:
    """A device file without its bytes; `position` counts uploads."""

    id: str
    kind: DeviceKind
    name: str
    version: str
    sha256: str
    expires: str | None
    uploaded_by: str
    position: int
    uploaded_at: str


_FILES = tables.device_files.c
_COLUMNS = tuple(_FILES[name] for name in StoredDevice.__slots__)
_WITH_BYTES = sa.select(*_COLUMNS, _FILES.content).where(_FILES.id.in_(sa.bindparam("ids", expanding=True)))


def add_device(connection: Connection, kind: DeviceKind, content: bytes, user_id: str) -> StoredDevice:
    """Store a file that its reader accepts; the same bytes again are the same device.

    ServiceError DEVICE_REFUSED with the reader's line, DEVICE_VERSION_TAKEN where other bytes have name and version.
    """
    parsed = parse_device(kind, content)
    before = _same_version(connection, kind, parsed)
    if before is not None:
        if before.sha256 == parsed.sha256:
            return before
        raise ServiceError(
            ErrorCode.DEVICE_VERSION_TAKEN, f"{kind} {parsed.name} version {parsed.version} is stored with other bytes"
        )
    device = StoredDevice(
        id=uuid4().hex,
        kind=kind,
        name=parsed.name,
        version=str(parsed.version),
        sha256=parsed.sha256,
        expires=parsed.expires.isoformat() if parsed.expires else None,
        uploaded_by=user_id,
        position=_uploads(connection) + 1,
        uploaded_at=now_utc(),
    )
    values = {name: getattr(device, name) for name in StoredDevice.__slots__}
    add_rows(connection, tables.device_files, [values | {"content": content}])
    describe(connection, action="device_stored", actor=user_id)
    return device


def parse_device(kind: DeviceKind, content: bytes) -> DeviceFile:
    """The file as its package reads it; ServiceError DEVICE_REFUSED."""
    try:
        return _reader(kind)(content)
    except ValueError as error:
        raise ServiceError(ErrorCode.DEVICE_REFUSED, str(error)) from error


def read_device(connection: Connection, device_id: str) -> StoredDevice:
    """One device file; ServiceError DEVICE_UNKNOWN."""
    return _one(connection, tables.device_files.c.id == device_id, f"there is no device file {device_id}")


def files_with_bytes(connection: Connection, device_ids: Collection[str]) -> dict[str, tuple[StoredDevice, bytes]]:
    """Device files with their bytes, by id, in one look; ServiceError DEVICE_UNKNOWN."""
    rows = connection.execute(_WITH_BYTES, {"ids": list(device_ids)})
    found = {row.id: (_device(row), row.content) for row in rows}
    for device_id in device_ids:
        if device_id not in found:
            raise ServiceError(ErrorCode.DEVICE_UNKNOWN, f"there is no device file {device_id}")
    return found


def newest_device(connection: Connection, kind: DeviceKind) -> StoredDevice:
    """The file of a kind that was uploaded last; ServiceError DEVICE_UNKNOWN."""
    files = tables.device_files
    return _one(connection, (files.c.kind == kind) & (files.c.position > 0), f"no {kind} file was uploaded")


def device_bytes(connection: Connection, device_id: str) -> bytes:
    """The bytes as uploaded; ServiceError DEVICE_UNKNOWN."""
    query = sa.select(tables.device_files.c.content).where(tables.device_files.c.id == device_id)
    content: bytes | None = connection.execute(query).scalar()
    if content is None:
        raise ServiceError(ErrorCode.DEVICE_UNKNOWN, f"there is no device file {device_id}")
    return content


def list_devices(connection: Connection) -> list[StoredDevice]:
    """Every device file, newest first."""
    rows = connection.execute(sa.select(*_COLUMNS).order_by(tables.device_files.c.position.desc()))
    return [_device(row) for row in rows]


def expired(device: StoredDevice, today: date) -> bool:
    """Whether the file's last day of use is past."""
    return device.expires is not None and date.fromisoformat(device.expires) < today


def _reader(kind: DeviceKind) -> Callable[[bytes], DeviceFile]:
    # Imported here: numpy is slow to import, and most commands never read a device.
    match kind:
        case DeviceKind.GUIDE:
            from vision.devices import read_guide

            return read_guide
        case DeviceKind.CARM:
            from vision.devices import read_carm

            return read_carm
        case DeviceKind.TCP:
            from robot.tool import read_tool

            return read_tool
        case DeviceKind.ROOM:
            from robot.room_shapes import read_room

            return read_room


def _uploads(connection: Connection) -> int:
    """How many files were uploaded; imported ones were not, and stand at positions below zero."""
    return max(connection.execute(sa.select(sa.func.max(tables.device_files.c.position))).scalar() or 0, 0)


def _same_version(connection: Connection, kind: DeviceKind, parsed: DeviceFile) -> StoredDevice | None:
    files = tables.device_files
    same = sa.and_(files.c.kind == kind, files.c.name == parsed.name, files.c.version == str(parsed.version))
    row = connection.execute(sa.select(*_COLUMNS).where(same)).first()
    return None if row is None else _device(row)


def _one(connection: Connection, condition: sa.ColumnElement[bool], missing: str) -> StoredDevice:
    query = sa.select(*_COLUMNS).where(condition).order_by(tables.device_files.c.position.desc()).limit(1)
    row = connection.execute(query).first()
    if row is None:
        raise ServiceError(ErrorCode.DEVICE_UNKNOWN, missing)
    return _device(row)


def _device(row: sa.Row[*tuple[Any, ...]]) -> StoredDevice:
    values = {name: row._mapping[name] for name in StoredDevice.__slots__}
    return StoredDevice(**values | {"kind": DeviceKind(row.kind)})

"""What `coaxial doctor` looks at, with or without a service running: each item measured, and what to do about it.

It changes nothing: no database, no key and no folder is made by looking.
"""

import os
import shutil
import subprocess
from collections.abc import Callable, Iterable, Iterator
from datetime import UTC, datetime
from pathlib import Path

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.auth.permissions import Role
from service.auth.users import UserStore
from service.conductor.check_items import CheckItem, device_items, item
from service.database import tables
from service.database.engines import Database, open_database
from service.database.migrate import newest_version, version_of
from service.devices.store import DeviceKind, list_devices
from service.errors import ServiceError, answer_for
from service.ledger.keys import kept_key
from service.operations.doctor_network import arm, dicom, http, peers
from service.settings import Settings

_ASK_S = 5.0
# A record is dated when its transaction begins; another writer's clock may be this much ahead.
_CLOCK_APART_S = 5.0
# Secrets that commands and docker-compose.yml ask for are no settings.
_NAMES = {*Settings.model_fields, "password", "pin", "database_password"}
_AS_ITS_OWNER = "Run this as the service's user, and give the data folder with all in it to that user"


def examine(settings: Settings) -> list[CheckItem]:
    """Every item, in the order in which a service needs them."""
    looks: tuple[Callable[[Settings], Iterable[CheckItem]], ...] = (
        _environment,
        _disk,
        _clock,
        _key,
        _anchor,
        _database,
        http,
        arm,
        dicom,
        peers,
    )
    return [one for look in looks for one in _typed(look, settings)]


def _typed(look: Callable[[Settings], Iterable[CheckItem]], settings: Settings) -> Iterator[CheckItem]:
    """What one look finds; a refusal on its way is found, too, and ends it."""
    try:
        yield from look(settings)
    except ServiceError as error:
        cure = answer_for(error.code).what_to_do
        yield item(error.code, False, error.measured or error.message, error.limit, "", cure)
    except OSError as error:
        told = f"{error.filename}: {error.strerror}"
        yield item("file_access", False, told, "readable", "", f"{_AS_ITS_OWNER}.")


def _environment(_: Settings) -> Iterable[CheckItem]:
    """Variables that look like settings and are none; in a settings file they would be refused."""
    cure = "Correct the variable's name, or take it away: what it was to set has its default."
    for name in sorted(os.environ):
        prefix, _mark, setting = name.lower().partition("_")
        if prefix == "coaxial" and setting.partition("__")[0] not in _NAMES:
            yield item("environment", False, name, "a setting's name", "", cure)


def _disk(settings: Settings) -> Iterable[CheckItem]:
    folder = settings.data_folder
    if not folder.is_dir():
        cure = "Add a first user: `coaxial user add`; it makes the folder, unless something else has its name."
        yield item("data_folder", False, str(folder), "a folder", "", cure)
        return
    writable = os.access(folder, os.W_OK | os.X_OK)
    yield item("data_folder_writable", writable, str(folder), "writable", "", f"{_AS_ITS_OWNER}; mount it for writing.")
    free = shutil.disk_usage(folder).free
    cure = "Free space on the data folder's disk, or move the folder; without it nothing is recorded and nothing moves."
    yield item("disk_free", free >= settings.min_free_bytes, free, settings.min_free_bytes, "bytes", cure)


def _clock(_: Settings) -> Iterable[CheckItem]:
    """Whether a time server keeps the clock; told where systemd can be asked, and left out where not."""
    command = ("timedatectl", "show", "--property", "NTPSynchronized", "--value")
    try:
        told = subprocess.run(command, capture_output=True, text=True, timeout=_ASK_S, check=True).stdout.strip()  # noqa: S603  fixed words
    except (OSError, subprocess.SubprocessError):
        return
    cure = "Turn on a time server (`timedatectl set-ntp true`): the record's times are the clock's."
    yield item("clock_synchronised", told == "yes", told, "yes", "", cure)


def _key(settings: Settings) -> Iterable[CheckItem]:
    key = kept_key(settings.key_file) if settings.key_file.exists() else None  # or the folder is out of reach
    if key is None:
        cure = (
            "Bring the room's own key back: another one vouches for no past. Where there was none, the start makes it."
        )
        yield item("signing_key", False, str(settings.key_file), "a key", "", cure)
        return
    name = key.verifier.name[:12]  # a key that others may read has been refused
    yield item("signing_key", True, name, None, "", "")


def _anchor(settings: Settings) -> Iterable[CheckItem]:
    """Whether what is named to be kept elsewhere is: a disk that is not mounted leaves an empty folder."""
    anchor = settings.audit.anchor_file
    if anchor is None or not settings.data_folder.is_dir():
        return
    nearest = next(folder for folder in anchor.absolute().parents if folder.is_dir())
    apart = nearest.stat().st_dev != settings.data_folder.stat().st_dev
    cure = "Mount the other machine's disk: the anchor guards the record only where who changes that does not reach it."
    yield item("anchor_elsewhere", apart, str(anchor), "another disk than the data folder's", "", cure)


def _database(settings: Settings) -> Iterable[CheckItem]:
    address = sa.make_url(settings.database_url)
    if address.get_backend_name() == "sqlite" and not Path(address.database or "").is_file():
        cure = "Add a first user: `coaxial user add`; it makes the database."
        yield item("database", False, str(address.database), "a file", "", cure)
        return
    database = open_database(settings.database_url)  # refuses a file that does not keep its journal durably
    try:
        yield from _opened(database)
    finally:
        database.close()


def _opened(database: Database) -> Iterable[CheckItem]:
    yield _mode(database)
    version, newest = version_of(database), newest_version()
    # Versions are numbers of one length, in the order of their migrations.
    is_newer = version is not None and newest is not None and version > newest
    cure = answer_for("schema_unknown" if is_newer else "schema_old").what_to_do
    yield item("database_schema", version == newest, version, newest, "", cure)
    if version != newest:
        return
    with database.read() as connection:
        reached = connection.execute(sa.select(sa.func.max(tables.ledger.c.reached_at))).scalar()
    if reached is not None:
        ahead_s = (datetime.fromisoformat(reached) - datetime.now(UTC)).total_seconds()
        cure = "Set the clock: the newest record is later than now. Ages and order do not rely on it, dates do."
        yield item("clock_after_record", ahead_s <= _CLOCK_APART_S, max(ahead_s, 0.0), _CLOCK_APART_S, "s", cure)
    surgeons = sum(user.role is Role.SURGEON for user in UserStore(database).list())
    yield item(
        "surgeons", surgeons > 0, str(surgeons), "1 or more", "", "Add one: `coaxial user add NAME --role surgeon`."
    )
    with database.read() as connection:
        yield from _devices(connection)


def _devices(connection: Connection) -> Iterable[CheckItem]:
    """What is missing, all at once; then whether each is in date."""
    uploaded = {device.kind for device in list_devices(connection)}
    missing = ", ".join(kind for kind in DeviceKind if kind not in uploaded)
    if missing:
        cure = "Upload each of them, as an engineer: `POST /api/devices/KIND`."
        yield item("device_unknown", False, f"nothing of {missing} was uploaded", "a file of each kind", "", cure)
        return
    yield from device_items(connection)


def _mode(database: Database) -> CheckItem:
    """How commits are kept through a power cut."""
    if database.writer.dialect.name == "sqlite":
        return item("database_durable", True, "WAL, synchronous FULL", "the same", "", "")
    names = ("fsync", "synchronous_commit", "full_page_writes")
    with database.read() as connection:
        off = [name for name in names if connection.execute(sa.text(f"SHOW {name}")).scalar() == "off"]
    cure = "Turn these on in postgresql.conf: a power cut would lose what was acknowledged."
    return item("database_durable", not off, ", ".join(off) or "on", "on", "", cure)

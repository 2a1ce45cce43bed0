"""A small record with a row in every table, signed and anchored, and an attacker who may write it."""

import shutil
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path

import pytest
import sqlalchemy as sa
from argon2 import PasswordHasher

from service.audit import record_audit
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases import store
from service.cases.attempts import record_attempt
from service.cases.records import ArtefactKind, NewArtefact, NewAttempt, NewCase, NewEvent, NewVerdict
from service.database import tables
from service.database.engines import Database, open_database
from service.database.migrate import migrate
from service.images.dicom_header import DicomHeader
from service.images.store import NewPurpose, add_image, assign_purpose
from service.ledger.anchor import advance_anchor
from service.ledger.draft import describe
from service.ledger.findings import Finding
from service.ledger.keys import Signer, signing_key
from service.ledger.rows import add_rows
from service.ledger.verifying import verify
from service.pacs.derived import DerivedObject, ObjectKind
from service.pacs.outbox import queue, record_delivery, undelivered
from tests.databases import ALL, Attacker, Databases

CASE = "case-1"
_PLAN = {"entry_mm": [0.0, 0.0, 0.1], "target_mm": [0.0, 40.0, 0.0]}
_VERDICTS = (
    NewVerdict("image_age", "H03", True, 12.3456789, 1800.0, "s", ""),
    NewVerdict("guide_empty", "H35", False, "wire", "empty", "", "the guide is not stated to be empty"),
)


@dataclass(frozen=True)
class Record:
    """A database with its key and its anchor."""

    folder: Path
    signer: Signer
    databases: Databases
    address: str

    @property
    def anchor(self) -> Path:
        return self.folder / "head.json"

    def open(self) -> Database:
        return open_database(self.address, self.signer)

    def findings(self) -> list[Finding]:
        with closing(self.open()) as database:
            return verify(database, {self.signer.verifier.name: self.signer.verifier}, self.anchor).findings

    def wheres(self) -> set[str]:
        return {finding.where for finding in self.findings()}

    def attack(self, change: Callable[[Attacker], object]) -> None:
        """Change the database as somebody does who has it: no triggers, no foreign keys."""
        with self.databases.attack(self.address) as attacker:
            change(attacker)

    def rows(self) -> dict[str, list[sa.Row[tuple[object, ...]]]]:
        """Every record row and every entry."""
        with closing(self.open()) as database, database.read() as connection:
            return {table.name: list(connection.execute(sa.select(table))) for table in ALL}


def fill(database: Database) -> None:
    """Two cases' worth of everything; the first is closed, the second goes on."""
    surgeon = UserStore(database, PasswordHasher(1, 8, 1)).add("anna", Role.SURGEON, "correct horse", "2468")
    for number, case_id in enumerate((CASE, "case-2")):
        case = NewCase(case_id, f"room-{number}", "P1", "1.2", surgeon.id, "0" * 64, {}, {"L3": _PLAN, "L4": _PLAN})
        with database.write() as connection:
            store.open_case(connection, case, _event("case_opened", surgeon.id))
    with database.write() as connection:
        record_audit(connection, "signed_in", surgeon.id, {"session": "s-1"})
        add_device(connection, surgeon.id)
    image_ids = [_image(database, number) for number in range(3)]
    for case_id in (CASE, "case-2"):
        _procedure(database, case_id, surgeon.id, image_ids)
        with database.write() as connection:
            describe(connection, checkpoint="case_closed")
            record_attempt(connection, _attempt(case_id, surgeon.id, "case_closed"))
            closed = "closed" if case_id == CASE else "case_open"
            event = NewEvent("case_closed" if case_id == CASE else "note", surgeon.id, closed, {}, {})
            store.append(connection, case_id, event, expected_version=None)
    with database.write() as connection:
        queue(connection, CASE, [DerivedObject(ObjectKind.ANNOTATED_IMAGE, "1.2.840", "2.25.7", b"a picture")])
    with database.write() as connection:
        (waiting,) = undelivered(connection)
        record_delivery(connection, waiting, "status 0x0000", accepted=True)
    with database.write() as connection:
        record_audit(connection, "signed_out", surgeon.id, {"session": "s-1"})


def add_device(connection: sa.Connection, user_id: str) -> None:
    values = {"id": "device-1", "kind": "tcp", "name": "tool", "version": "1", "sha256": "f" * 64, "expires": None}
    more = {"content": b"name = 1", "uploaded_by": user_id, "position": 1, "uploaded_at": "2026-01-01T00:00:00.000000Z"}
    add_rows(connection, tables.device_files, [values | more])


def _image(database: Database, number: int) -> str:
    header = DicomHeader(f"1.{number}", f"{number}" * 64, "P1", "1.2", {"rows": 96})
    with database.write() as connection:
        image = add_image(connection, b"image %d" % number, header, None, {"calling_ae": "CARM"})
    with database.write() as connection:
        assign_purpose(connection, NewPurpose(image.id, CASE, "registration", {"joints_rad": [0.1]}, ()))
    return image.id


def _procedure(database: Database, case_id: str, user_id: str, image_ids: list[str]) -> None:
    columns = {
        ArtefactKind.REGISTRATION: {"image_id": image_ids[0]},
        ArtefactKind.EVALUATION: {"image_id": image_ids[1]},
        ArtefactKind.PERMIT: {"approved_by": user_id},
        ArtefactKind.MOTION: {"trajectory": bytes(range(64))},
        ArtefactKind.IMAGE_ASSIGNMENT: {"image_id": image_ids[2], "number": 1 if case_id == CASE else 2},
    }
    for kind in ArtefactKind:
        made_id = f"{case_id}-{'permits' if kind is ArtefactKind.PERMIT_USE else kind}"
        artefact = NewArtefact(kind, made_id, (), {"value": 0.1234567}, columns.get(kind, {}))
        with database.write() as connection:
            record_attempt(connection, _attempt(case_id, user_id, "plan_requested"))
            store.append(connection, case_id, _event("x", user_id), expected_version=None, artefacts=[artefact])


def _attempt(case_id: str, user_id: str, trigger: str) -> NewAttempt:
    return NewAttempt(case_id, user_id, trigger, True, "taken", "", "case_open", _VERDICTS)


def _event(trigger: str, user_id: str) -> NewEvent:
    return NewEvent(trigger, user_id, "case_open", {"state": "case_open", "note": "µ"}, {"row": 1})


@pytest.fixture(scope="session")
def kept_record(tmp_path_factory: pytest.TempPathFactory, databases: Databases) -> Iterator[Record]:
    """Made once; tests work on copies."""
    folder = tmp_path_factory.mktemp("record")
    with databases.empty(folder) as address:
        made = Record(folder, signing_key(folder / "signing.key"), databases, address)
        with closing(made.open()) as database:
            migrate(database)
            fill(database)
            advance_anchor(database, made.anchor, made.signer)
        yield made


@pytest.fixture
def record(kept_record: Record, tmp_path: Path, databases: Databases) -> Iterator[Record]:
    shutil.copy(kept_record.anchor, tmp_path)
    with databases.copied(kept_record.address, tmp_path) as address:
        yield Record(tmp_path, kept_record.signer, databases, address)


@pytest.fixture(scope="session")
def fill_record() -> Callable[[Database], None]:
    return fill

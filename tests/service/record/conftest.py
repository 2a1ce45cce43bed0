"""A closed case with two rendered images and what was computed from them, made once; tests work on copies."""

import copy
import hashlib
import json
import pickle
import shutil
import sqlite3
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import pytest
from argon2 import PasswordHasher

from benchmarks import recorded_cases
from benchmarks.computed_results import compute
from service import vision_jobs
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.cases import store
from service.cases.attempts import record_attempt
from service.cases.records import NewAttempt, NewEvent, NewVerdict
from service.database.current import current_database
from service.settings import Settings
from workflow.states import State


@dataclass(frozen=True)
class Site:
    """A data folder with one case in its record."""

    folder: Path
    case_id: str

    @property
    def settings(self) -> Settings:
        return Settings(data_folder=self.folder, min_free_bytes=0)

    def attack(self, change: Callable[[sqlite3.Connection], object]) -> None:
        """Change the database file as somebody does who has it: no triggers, no foreign keys."""
        with sqlite3.connect(self.folder / "coaxial.sqlite") as connection:
            for (name,) in connection.execute("SELECT name FROM sqlite_master WHERE type = 'trigger'").fetchall():
                connection.execute(f"DROP TRIGGER {name}")
            change(connection)
        connection.close()

    def alter(self, table: str, change: Callable[[dict[str, Any]], object]) -> str:
        """Change the content of a table's first artefact; its id."""
        artefact_id = ""

        def write(connection: sqlite3.Connection) -> None:
            nonlocal artefact_id
            artefact_id, text = connection.execute(f"SELECT id, content FROM {table} ORDER BY sequence").fetchone()
            content = json.loads(text)
            change(content)
            connection.execute(f"UPDATE {table} SET content = ? WHERE id = ?", (json.dumps(content), artefact_id))

        self.attack(write)
        return artefact_id


@pytest.fixture(scope="session")
def results() -> recorded_cases.Results:
    return compute(Settings())


@pytest.fixture(scope="session")
def make_site(results: recorded_cases.Results) -> Callable[..., Site]:
    def make(folder: Path, *states: State, **more: Any) -> Site:
        settings = Settings(data_folder=folder, min_free_bytes=0, **more)
        with current_database(settings) as database:
            surgeon = UserStore(database, PasswordHasher(1, 8, 1)).add("anna", Role.SURGEON, "correct horse", "2468")
            for state in states:
                case_id = recorded_cases.record(database, settings, surgeon.id, results, state)
            with database.write() as connection:  # an entry behind the signature of the closing
                last = store.newest_event(connection, case_id)
                record_attempt(connection, _refused_motion(case_id, surgeon.id, last.state))
                note = NewEvent("note", surgeon.id, last.state, last.case_state, {"text": "seen"}, changes_state=False)
                store.append(connection, case_id, note, expected_version=None)
        return Site(folder, case_id)

    return make


# A figure of each kind that interlocks measure: whole, true, text, none; and one that SQLite keeps as its neighbour.
FIGURES: tuple[tuple[Any, Any], ...] = (
    (0.25, 0.3),
    (120.0, 120),
    (False, True),
    ("4.1", "5.0"),
    (None, None),
    (-0.04341816603136937, 0.30000000000000004),
)


def _refused_motion(case_id: str, user_id: str, state: str) -> NewAttempt:
    verdicts = tuple(
        NewVerdict(f"interlock_{number}", "H04", False, measured, limit, "mm", "measured")
        for number, (measured, limit) in enumerate(FIGURES)
    )
    return NewAttempt(case_id, user_id, "approved", False, "interlock", "refused", state, verdicts)


_ANSWERS: dict[bytes, Any] = {}


@pytest.fixture
def remembered_jobs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Image work in this process that was done once is not done again: it takes a second, and gives the same."""
    for name in ("register", "evaluate"):
        monkeypatch.setattr(vision_jobs, name, partial(_remembered, name, getattr(vision_jobs, name)))


def _remembered(name: str, real: Callable[..., Any], *arguments: Any) -> Any:
    asked = hashlib.sha256(pickle.dumps((name, arguments))).digest()
    if asked not in _ANSWERS:
        _ANSWERS[asked] = real(*arguments)
    return copy.deepcopy(_ANSWERS[asked])


@pytest.fixture(scope="session")
def kept_site(tmp_path_factory: pytest.TempPathFactory, make_site: Callable[..., Site]) -> Site:
    return make_site(tmp_path_factory.mktemp("site"), State.CLOSED)


@pytest.fixture
def site(kept_site: Site, tmp_path: Path) -> Site:
    folder = tmp_path / "site"
    shutil.copytree(kept_site.folder, folder)
    return Site(folder, kept_site.case_id)

"""Records one whole case and acknowledges each commit: the process whose system calls are made to fail.

    python -m benchmarks.evidence.whole_case FOLDER [NAME=VALUE ...]

FOLDER is a prepared one (`prepare`). Every line on standard output is an acknowledgement (`entry N`), a refusal of the
database (`refused CODE`), or, behind a refusal, what could be read nevertheless (`read N`). A step that is refused is
tried again a few times, as its sender would. NAME=VALUE replaces a PRAGMA of the product's: for the modes that are
known to lose what they acknowledge.
"""

import os
import pickle
import sys
from contextlib import AbstractContextManager, nullcontext
from dataclasses import replace
from io import BytesIO
from pathlib import Path
from unittest.mock import patch

import numpy as np
from argon2 import PasswordHasher
from pydicom import dcmread

from benchmarks import recorded_cases
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.database import engines
from service.database.current import current_database
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.ledger.entries import head_of
from service.settings import Settings
from workflow.states import State

RESULTS = "results.pickle"
_TRIES = 4
_SMALL_PX = 96  # sides of a small image


def settings_of(folder: Path) -> Settings:
    """A data folder's; free space is what the tests take away by other means."""
    return Settings(data_folder=folder, min_free_bytes=0)


def prepare(folder: Path, *, small: bool = False) -> None:
    """A data folder with schema, key and surgeon, and the results of a case yet to be recorded.

    With small images each system call of the case can be made to fail in turn; whole ones fill the journal, so that it
    is written into the database amid the case.
    """
    settings = settings_of(folder)
    with current_database(settings) as database:
        UserStore(database, PasswordHasher(1, 8, 1)).add("anna", Role.SURGEON, "correct horse", "2468")
    results = recorded_cases.compute(settings)
    if small:
        results = replace(results, images=tuple(_cropped(image) for image in results.images))
    (folder / RESULTS).write_bytes(pickle.dumps(results))


def _cropped(image: bytes) -> bytes:
    dataset = dcmread(BytesIO(image))
    dataset.PixelData = np.ascontiguousarray(dataset.pixel_array[:_SMALL_PX, :_SMALL_PX]).tobytes()
    dataset.Rows = dataset.Columns = _SMALL_PX
    file = BytesIO()
    dataset.save_as(file)
    return file.getvalue()


def record_whole_case(folder: Path) -> None:
    """One case from its device files to its end."""
    settings, results = settings_of(folder), pickle.loads((folder / RESULTS).read_bytes())
    with current_database(settings) as database:
        (surgeon,) = UserStore(database).list()
        database.on_commit.append(lambda: _say("entry", newest(database)))
        for step in recorded_cases.Recording(settings, surgeon.id, results, State.CLOSED).steps():
            _take(database, step)


def newest(database: Database) -> int:
    """Number of the newest entry of the ledger."""
    with database.read() as connection:
        return head_of(connection).sequence


def _take(database: Database, step: recorded_cases.Step) -> None:
    for _ in range(_TRIES):
        try:
            with database.write() as connection:
                step(connection)
        except ServiceError as error:
            _say("refused", error.code)
            _say("read", newest(database))
        else:
            return
    raise ServiceError(ErrorCode.DATABASE_FAULT, "refused again and again")


def _say(word: str, what: object) -> None:
    """In one call: nothing of an acknowledgement is kept back."""
    os.write(1, f"{word} {what}\n".encode())


def _pragmas(replaced: dict[str, str]) -> "AbstractContextManager[object]":
    """The product asserts its PRAGMAs on every connection: others take their place."""

    def assert_pragma(dbapi: object, name: str, value: str, _expected: object) -> None:
        dbapi.execute(f"PRAGMA {name}={replaced.get(name, value)}")  # type: ignore[attr-defined]  # a sqlite3 one

    return patch.object(engines, "_assert_pragma", assert_pragma)


if __name__ == "__main__":
    others = dict(argument.split("=") for argument in sys.argv[2:])
    try:
        with _pragmas(others) if others else nullcontext():
            record_whole_case(Path(sys.argv[1]))
    except ServiceError as error:
        _say("refused", error.code)
        sys.exit(1)

"""Records one whole case and acknowledges each commit: the process whose system calls are made to fail.

    python -m benchmarks.evidence.whole_case FOLDER [NAME=VALUE ...]

FOLDER is one that `inputs` prepares. Every line on standard output is an acknowledgement (`entry N`), a refusal of the
database (`refused CODE`), or, behind a refusal, what could be read nevertheless (`read N`). A step that is refused is
tried again a few times, as its sender would. NAME=VALUE replaces a PRAGMA of the product's: for the modes that are
known to lose what they acknowledge.
"""

import ctypes
import os
import pickle
import sys
import time
from collections.abc import Sequence
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from unittest.mock import patch

from benchmarks import recorded_cases
from service.auth.users import UserStore
from service.database import engines
from service.database.current import current_database
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.ledger.entries import head_of
from service.settings import Settings
from workflow.states import State

RESULTS = "results.pickle"
# What trials begin with, by name in the folder of their inputs: folders that are prepared, and one that is recorded.
SMALL, WHOLE, RECORDED = "small-images", "whole-images", "recorded"
_TRIES = 4
_PR_SET_PTRACER, _ANYBODY = 0x59616D61, -1  # of prctl(2)
_LOOK_S = 0.001


def settings_of(folder: Path) -> Settings:
    """A data folder's; free space is what the tests take away by other means."""
    return Settings(data_folder=folder, min_free_bytes=0)


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


def main(folder: Path, others: Sequence[str] = ()) -> None:
    """Record, with other PRAGMAs where some are named; exit status 1 where the database refused for good."""
    replaced = dict(other.split("=") for other in others)
    try:
        with _pragmas(replaced) if replaced else nullcontext():
            record_whole_case(folder)
    except ServiceError as error:
        _say("refused", error.code)
        sys.exit(1)


def record_once_traced(folder: Path, said: Path, errors: Path) -> None:
    """The same in a process that another one traces, standard output and errors into files."""
    ctypes.CDLL(None).prctl(_PR_SET_PTRACER, ctypes.c_ulong(_ANYBODY))  # else Yama allows a parent alone to trace
    for file, descriptor in ((said, 1), (errors, 2)):
        os.dup2(os.open(file, os.O_WRONLY | os.O_CREAT), descriptor)
    while "TracerPid:\t0" in Path("/proc/self/status").read_text():
        time.sleep(_LOOK_S)
    main(folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]), sys.argv[2:])

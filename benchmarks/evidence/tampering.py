"""Bits flipped in a recorded case by somebody who has the file and not the key: found, or no record has changed."""

import shutil
import sqlite3
from collections.abc import Iterator, Sequence
from contextlib import closing
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from benchmarks.evidence.item import Trial
from benchmarks.evidence.power_loss import Onlooker
from benchmarks.evidence.whole_case import RECORDED, settings_of
from service.database import tables

_TABLES = sorted(table.name for table in (*tables.RECORDS, *tables.LEDGER))


def flips(inputs: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """One bit of the database's file for each number."""
    recorded = inputs / RECORDED
    with TemporaryDirectory() as place:
        victim = Path(place) / "data"
        shutil.copytree(recorded, victim)
        content = _file(recorded).read_bytes()
        rows, onlooker = rows_of(_file(recorded)), Onlooker(victim)
        for number in numbers:
            bit = Random(number).randrange(len(content) * 8)
            _lay(_file(victim), content, bit)
            found = onlooker.look()[1]
            unseen = not found and is_changed(_file(victim), rows)
            yield {"number": number, "kind": "found" if found else "no record changed", "bad": unseen, "bit": bit}


def _file(folder: Path) -> Path:
    return Path(str(settings_of(folder).database_url).removeprefix("sqlite:///"))


def _lay(file: Path, content: bytes, bit: int) -> None:
    """The file with one bit changed, and nothing kept from the last one."""
    for beside in file.parent.glob(f"{file.name}-*"):
        beside.unlink()
    changed = bytearray(content)
    changed[bit // 8] ^= 1 << bit % 8
    file.write_bytes(changed)


def is_changed(file: Path, rows: list[object]) -> bool:
    """Whether it has other rows, or rows that nobody can read any more."""
    try:
        return rows_of(file) != rows
    except (sqlite3.Error, UnicodeDecodeError):  # the latter over a column's name
        return True


def rows_of(file: Path) -> list[object]:
    """Every row of the record and its ledger."""
    with closing(sqlite3.connect(f"file:{file}?mode=ro", uri=True)) as connection:
        return [row for name in _TABLES for row in connection.execute(f"SELECT rowid, * FROM {name} ORDER BY rowid")]

"""What the evidence consists of."""

import shutil
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.evidence import failing_calls, tampering
from benchmarks.evidence.failing_calls import FAILING, KILLED, prepared_in
from benchmarks.evidence.item import Item, Trial, Trials
from benchmarks.evidence.power_loss import cuts
from benchmarks.evidence.system_calls import recorded
from benchmarks.fuzz import http_requests
from benchmarks.fuzz import trials as fuzzing
from benchmarks.states import kills, races, sequences

# Modes that SQLite documents as losing commits, or all of the database, to a power cut; the product asserts WAL and
# FULL. A rollback journal is known to lose the last commit at FULL, for its removal is not synced (EXTRA is for that).
_LOSING = (
    ("synchronous=NORMAL",),
    ("synchronous=OFF",),
    ("journal_mode=DELETE", "synchronous=OFF"),
    ("journal_mode=DELETE", "synchronous=FULL"),
    ("journal_mode=MEMORY",),
    ("journal_mode=OFF",),
)
_CUTS_OF_A_MODE = 300


def _always(count: int) -> Callable[[Path], int]:
    return lambda _folder: count


def _power_cuts(folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Every other number is a case with whole images, whose journal is written into the database on its way."""
    for small in (True, False):
        chosen = [number for number in numbers if (number % 2 == 0) is small]
        for found in _cuts(prepared_in(folder, small=small), chosen, ()):
            yield {
                "number": found["seed"],
                "kind": found["loss"],
                "bad": bool(found["lost"] or found["corrupt"]),
            } | found


def _losing_modes(folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Whether the replay tells that a mode loses what it acknowledges."""
    for number in numbers:
        found = list(_cuts(prepared_in(folder), range(_CUTS_OF_A_MODE), _LOSING[number]))
        lost, corrupt = (sum(bool(one[name]) for one in found) for name in ("lost", "corrupt"))
        of = {"cuts": len(found), "lost": lost, "corrupt": corrupt}
        yield {"number": number, "kind": ", ".join(_LOSING[number]), "bad": lost + corrupt == 0} | of


def _cuts(prepared: Path, seeds: Sequence[int], pragmas: Sequence[str]) -> Iterator[Trial]:
    if not seeds:
        return
    with TemporaryDirectory() as place:
        victim = Path(place) / "data"
        shutil.copytree(prepared, victim)
        calls = recorded(victim, pragmas)
        for found in cuts(prepared, calls, seeds, Path(place) / "cut"):
            yield asdict(found) | {"lost": found.lost}


def _of_a_whole_case(name: str, what: str, asked: str, faults: Sequence[str]) -> Item:
    """Every call in turn with every fault."""

    def count(folder: Path) -> int:
        return failing_calls.writing_calls(folder) * len(faults)

    return Item(name, what, asked, count, partial(failing_calls.trials, faults=faults), at_once=20)


def _contested(database: str, trials: Trials) -> Item:
    what = f"one permit held by {races.FEWEST} to {races.MOST} clients at once, {database}"
    return Item(
        f"contested_permits_{database.lower()}", what, "exactly one motion", _always(10_000), trials, at_once=200
    )


ITEMS = (
    _of_a_whole_case(
        "kill_at_every_write",
        "SIGKILL at every write or sync of one whole case",
        "0 acknowledged lost, 0 corrupt",
        KILLED,
    ),
    _of_a_whole_case(
        "failing_writes",
        "every write or sync of one whole case fails once, and from then on: disk full, I/O error",
        "typed refusal, reads served, 0 acknowledged lost, goes on when space returns",
        FAILING,
    ),
    Item(
        "power_loss",
        "power cut: unsynced writes dropped, kept, cut, reordered or torn",
        "0 acknowledged lost, 0 corrupt",
        _always(200_000),
        _power_cuts,
        at_once=2000,
    ),
    Item(
        "losing_modes",
        "the same with modes of SQLite that are known to lose",
        "each is flagged",
        _always(len(_LOSING)),
        _losing_modes,
        at_once=1,
    ),
    Item(
        "tampering",
        "one bit of the database's file flipped",
        "found, or no record changed",
        _always(20_000),
        tampering.flips,
        at_once=500,
    ),
    Item(
        "reference_model",
        f"random sequences of {sequences.STEPS} commands, facts and observations over HTTP against a reference model",
        "0 differences",
        _always(20_000),
        sequences.sequences,
        at_once=100,
    ),
    Item(
        "kill_at_any_moment",
        "SIGKILL of the running service at random moments of a procedure",
        "0 acknowledged lost, 0 there twice, 0 motion after the start",
        _always(2_000),
        kills.kills,
        at_once=50,
    ),
    _contested("SQLite", races.on_sqlite),
    _contested("PostgreSQL", races.on_postgresql),
    *fuzzing.items(),
    http_requests.item(),
)

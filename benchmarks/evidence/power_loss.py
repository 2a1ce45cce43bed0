"""Power cuts: the calls of a whole case, replayed onto a disk that keeps what was synced and any part of the rest.

Each state of the disk is opened as the next start of the service would: what was acknowledged must be in it, and the
record must be whole by its own verification. The modes of SQLite that are known to lose what they acknowledge show that
the replay would tell.
"""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import asdict, dataclass
from hashlib import sha256
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory

from benchmarks.evidence.disk import Disk, Loss
from benchmarks.evidence.item import Trial
from benchmarks.evidence.raised import trial_of
from benchmarks.evidence.system_calls import Call, recorded
from benchmarks.evidence.whole_case import SMALL, WHOLE, newest, settings_of
from service.database.engines import Database, open_database
from service.errors import ServiceError
from service.ledger.keys import Signer, signing_key
from service.ledger.verifying import verify

_LOSSES = tuple(Loss)
# Modes that SQLite documents as losing commits, or all of the database, to a power cut; the product asserts WAL and
# FULL. A rollback journal is known to lose the last commit at FULL, for its removal is not synced (EXTRA is for that).
LOSING = (
    ("synchronous=NORMAL",),
    ("synchronous=OFF",),
    ("journal_mode=DELETE", "synchronous=OFF"),
    ("journal_mode=DELETE", "synchronous=FULL"),
    ("journal_mode=MEMORY",),
    ("journal_mode=OFF",),
)
_CUTS_OF_A_MODE = 300


@dataclass(frozen=True, slots=True)
class Found:
    """What one power cut left."""

    seed: int
    loss: Loss
    after_call: int
    acknowledged: int  # newest entry that the service had answered for
    entries: int  # newest entry that is there
    corrupt: str = ""  # the first finding of the verification, or why it did not open

    @property
    def lost(self) -> int:
        """Acknowledged entries that are gone."""
        return max(0, self.acknowledged - self.entries)


def power_cuts(inputs: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Every other number is a case with whole images, whose journal is written into the database on its way."""
    for remainder, images in enumerate((SMALL, WHOLE)):
        for found in _cut(inputs / images, [number for number in numbers if number % 2 == remainder], ()):
            bad = bool(found.lost or found.corrupt)
            yield {"number": found.seed, "kind": found.loss, "bad": bad} | asdict(found) | {"lost": found.lost}


def losing_modes(inputs: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Whether the replay tells that a mode loses what it acknowledges."""
    for number in numbers:
        found = list(_cut(inputs / SMALL, range(_CUTS_OF_A_MODE), LOSING[number]))
        lost, corrupt = sum(one.lost > 0 for one in found), sum(bool(one.corrupt) for one in found)
        of = {"cuts": len(found), "lost": lost, "corrupt": corrupt}
        yield {"number": number, "kind": ", ".join(LOSING[number]), "bad": lost + corrupt == 0} | of


def _cut(prepared: Path, seeds: Sequence[int], pragmas: Sequence[str]) -> Iterator[Found]:
    """Power cuts of one whole case, recorded for them."""
    if not seeds:
        return
    with TemporaryDirectory() as place:
        victim = Path(place) / "data"
        shutil.copytree(prepared, victim)
        calls = recorded(victim, pragmas)
        yield from cuts(prepared, calls, seeds, Path(place) / "cut")


def cuts(prepared: Path, calls: Sequence[Call], seeds: Sequence[int], place: Path) -> Iterator[Found]:
    """One power cut for each seed, `seeds` in order of time: the seed says when, and what is lost."""
    drawn = sorted((Random(seed).randrange(len(calls)), seed) for seed in seeds)
    disk, acknowledged, done, onlooker = Disk(prepared), _entries(prepared), 0, Onlooker(place)
    known: dict[bytes, tuple[int, str]] = {}  # many cuts leave the same, and so does whatever looks at it
    for moment, seed in drawn:
        with trial_of(seed):
            for call in calls[done : moment + 1]:
                disk.do(call)
                acknowledged = max(acknowledged, _acknowledgement(call))
            done = moment + 1
            loss = _LOSSES[seed % len(_LOSSES)]
            left = disk.cut(loss, Random(seed))
            state = _digest(left)
            if state not in known:
                _lay(left, place)
                known[state] = onlooker.look()
            entries, corrupt = known[state]
            yield Found(seed, loss, moment, acknowledged, entries, corrupt)


def _acknowledgement(call: Call) -> int:
    word, _, number = call.data.decode().partition(" ") if call.path == "stdout" else ("", "", "")
    return int(number) if word == "entry" else 0


def _digest(files: dict[str, bytes]) -> bytes:
    digest = sha256()
    for name, content in sorted(files.items()):
        digest.update(f"{name}\0{len(content)}\0".encode() + content)
    return digest.digest()


def _lay(files: dict[str, bytes], place: Path) -> None:
    shutil.rmtree(place, ignore_errors=True)
    for name, content in files.items():
        file = place / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch(mode=0o600)
        file.write_bytes(content)


class Onlooker:
    """Looks at one folder again and again, whatever lies there then.

    Engines are kept, connections are not: putting every statement together anew took a third of each look.
    """

    def __init__(self, folder: Path) -> None:
        self._settings = settings_of(folder)
        self._database: Database | None = None

    def look(self) -> tuple[int, str]:
        """Newest entry, and what the verification finds."""
        signer = signing_key(self._settings.key_file)
        try:
            database = self._opened(signer)
            found = verify(database, {signer.verifier.name: signer.verifier}, self._settings.anchor_file).findings
            return newest(database), str(found[0]) if found else ""
        except ServiceError as error:
            return 0, str(error)
        finally:
            if self._database is not None:
                self._database.close()

    def _opened(self, signer: Signer) -> Database:
        if self._database is None:
            self._database = open_database(self._settings.database_url, signer)
        else:
            self._database.prove()
        return self._database


def look(folder: Path) -> tuple[int, str]:
    """Once: newest entry, and what the verification finds."""
    return Onlooker(folder).look()


def _entries(folder: Path) -> int:
    with closing(open_database(settings_of(folder).database_url)) as database:
        return newest(database)

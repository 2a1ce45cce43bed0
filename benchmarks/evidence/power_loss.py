"""Power cuts: the calls of a whole case, replayed onto a disk that keeps what was synced and any part of the rest.

Each state of the disk is opened as the next start of the service would: what was acknowledged must be in it, and the
record must be whole by its own verification. The modes of SQLite that are known to lose what they acknowledge show that
the replay would tell.
"""

import shutil
from collections.abc import Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from random import Random

from benchmarks.evidence.disk import Disk, Loss
from benchmarks.evidence.system_calls import Call
from benchmarks.evidence.whole_case import newest, settings_of
from service.database.engines import open_database
from service.errors import ServiceError
from service.ledger.keys import signing_key
from service.ledger.verifying import verify

_LOSSES = tuple(Loss)


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


def cuts(prepared: Path, calls: Sequence[Call], seeds: Sequence[int], place: Path) -> Iterator[Found]:
    """One power cut for each seed, `seeds` in order of time: the seed says when, and what is lost."""
    drawn = sorted((Random(seed).randrange(len(calls)), seed) for seed in seeds)
    disk, acknowledged, done = Disk(prepared), _entries(prepared), 0
    for moment, seed in drawn:
        for call in calls[done : moment + 1]:
            disk.do(call)
            acknowledged = max(acknowledged, _acknowledgement(call))
        done = moment + 1
        loss = _LOSSES[seed % len(_LOSSES)]
        _lay(disk.cut(loss, Random(seed)), place)
        entries, corrupt = look(place)
        yield Found(seed, loss, moment, acknowledged, entries, corrupt)


def _acknowledgement(call: Call) -> int:
    word, _, number = call.data.decode().partition(" ") if call.path == "stdout" else ("", "", "")
    return int(number) if word == "entry" else 0


def _lay(files: dict[str, bytes], place: Path) -> None:
    shutil.rmtree(place, ignore_errors=True)
    for name, content in files.items():
        file = place / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch(mode=0o600)
        file.write_bytes(content)


def look(folder: Path) -> tuple[int, str]:
    """Newest entry, and what the verification finds."""
    settings = settings_of(folder)
    signer = signing_key(settings.key_file)
    try:
        with closing(open_database(settings.database_url, signer)) as database:
            found = verify(database, {signer.verifier.name: signer.verifier}, settings.anchor_file).findings
            return newest(database), str(found[0]) if found else ""
    except ServiceError as error:
        return 0, str(error)


def _entries(folder: Path) -> int:
    with closing(open_database(settings_of(folder).database_url)) as database:
        return newest(database)

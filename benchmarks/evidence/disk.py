"""What a disk may hold after a power cut: all that was synced, and of the rest any part, in any order.

A file's writes and truncations are sure once the file has been synced, its name once the folder has been. Whatever was
not may have reached the disk whole, in part, in any order, or not at all; a single write may be torn at a sector. Names
change in their order, as file systems with a journal do it.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field
from enum import StrEnum
from itertools import pairwise
from pathlib import Path
from random import Random

from benchmarks.evidence.system_calls import Call

SECTOR = 512  # bytes that a disk writes whole
_SYNCS = ("fsync", "fdatasync")


class Loss(StrEnum):
    """What a power cut does to calls that were not synced."""

    DROPPED = "dropped"  # none of them
    KEPT = "kept"  # all
    CUT = "cut"  # the first ones
    REORDERED = "reordered"  # any of them
    TORN = "torn"  # any of their sectors


@dataclass
class File:
    """A file's sure content, and the calls after it."""

    sure: bytearray = field(default_factory=bytearray)
    since: list[Call] = field(default_factory=list)

    def sync(self) -> None:
        """Everything so far is sure."""
        for call in self.since:
            _apply(self.sure, call)
        self.since.clear()

    def after(self, loss: Loss, random: Random) -> bytes:
        """One content that a power cut may leave."""
        content = bytearray(self.sure)
        for call in _surviving(self.since, loss, random):
            _apply(content, call)
        return bytes(content)


class Disk:
    """Files by name as they are, and the changes of names since the folder was synced."""

    def __init__(self, folder: Path) -> None:
        self._sure: dict[str, File] = {
            str(file.relative_to(folder)): File(bytearray(file.read_bytes()))
            for file in folder.rglob("*")
            if file.is_file()
        }
        self._now = dict(self._sure)
        self._names: list[dict[str, File]] = []  # every state of the names since the last sync

    def do(self, call: Call) -> None:
        """Follow one call of the process."""
        match call.name:
            case "openat" if call.path not in self._now:
                self._rename(self._now | {call.path: File()})
            case "rename":
                others = {name: file for name, file in self._now.items() if name != call.path}
                self._rename(others | {call.to: self._now[call.path]})
            case "unlink":
                self._rename({name: file for name, file in self._now.items() if name != call.path})
            case "pwrite64" | "write" | "ftruncate" if call.path in self._now:
                self._now[call.path].since.append(call)
            case sync if sync in _SYNCS and call.path in self._now:
                self._now[call.path].sync()
            case sync if sync in _SYNCS:
                self._sure, self._names = dict(self._now), []

    def _rename(self, names: dict[str, File]) -> None:
        self._now = names
        self._names.append(names)

    def cut(self, loss: Loss, random: Random) -> dict[str, bytes]:
        """One state that a power cut may leave now, by file name."""
        reached = random.randint(0, len(self._names))
        names = {Loss.DROPPED: self._sure, Loss.KEPT: self._now}.get(loss) or (self._sure, *self._names)[reached]
        return {name: file.after(loss, random) for name, file in names.items()}


def _apply(content: bytearray, call: Call) -> None:
    if call.name == "ftruncate":
        del content[call.number :]
        content.extend(bytes(call.number - len(content)))
        return
    at = call.number if call.name == "pwrite64" else len(content)
    content.extend(bytes(max(0, at - len(content))))
    content[at : at + len(call.data)] = call.data


def _surviving(calls: list[Call], loss: Loss, random: Random) -> Iterable[Call]:
    match loss:
        case Loss.DROPPED:
            return ()
        case Loss.KEPT:
            return tuple(calls)
        case Loss.CUT:
            return tuple(calls[: random.randint(0, len(calls))])
        case Loss.REORDERED:
            return tuple(call for call in calls if random.random() < 0.5)
        case Loss.TORN:
            return tuple(part for call in calls for part in _sectors(call) if random.random() < 0.5)


def _sectors(call: Call) -> Iterable[Call]:
    """A write in parts that end where sectors do; whatever else is one."""
    if call.name != "pwrite64":
        return (call,)
    start, end = call.number, call.number + len(call.data)
    cuts = [start, *range(start - start % SECTOR + SECTOR, end, SECTOR), end]
    pairs = pairwise(cuts)
    return tuple(Call(call.name, call.path, call.data[a - start : b - start], a) for a, b in pairs)

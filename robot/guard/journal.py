"""The guard's own record: JSON lines, forced to disk at events; a trajectory file for each motion.

A thread of its own writes, so that a slow or full disk delays no stop (H24).
"""

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from io import FileIO
from pathlib import Path
from queue import SimpleQueue
from threading import Event as Signal
from threading import Thread
from typing import Any

from robot.arm import ArmState
from robot.guard.lines import encode, plain
from robot.guard.messages import Command, Event

EVENTS_FILE = "guard.jsonl"
# Before and after a motion, never amid one. The parent hears nothing meanwhile, and after a second it kills the guard.
FLUSH_S = 0.7


@dataclass(frozen=True, slots=True)
class _Append:
    file: str
    line: bytes
    durable: bool


class _Flush:
    def __init__(self) -> None:
        self.done = Signal()
        self.complete = False


class Journal:
    """Appends to files of a folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._jobs: SimpleQueue[_Append | _Flush | None] = SimpleQueue()
        self._files: dict[str, FileIO] = {}
        self._thread = Thread(target=self._work, name="journal", daemon=True)
        self._failed = False
        self._thread.start()

    def record(self, message: Command | Event) -> None:
        """Append a message, forced to disk; returns at once."""
        self._jobs.put(_Append(EVENTS_FILE, encode(message), durable=True))

    def sample(self, permit_id: str, reading: ArmState) -> None:
        """Append a reading to a motion's trajectory; returns at once."""
        self._jobs.put(_Append(trajectory_file(permit_id), _line(_sample(reading)), durable=False))

    def flush(self, timeout_s: float) -> bool:
        """Wait until all since the last flush is on the disk; False if something is not, or not in time."""
        flush = _Flush()
        self._jobs.put(flush)
        return flush.done.wait(timeout_s) and flush.complete

    def close(self) -> None:
        """Write what is left and end the thread."""
        self._jobs.put(None)
        self._thread.join(timeout=2.0)

    def _work(self) -> None:
        while (job := self._jobs.get()) is not None:
            try:
                self._append(job) if isinstance(job, _Append) else self._sync()
            except OSError:
                self._failed = True  # told by the next flush, which every motion awaits before it starts
            if isinstance(job, _Flush):
                job.complete, self._failed = not self._failed, False
                job.done.set()
        self._close_files()

    def _append(self, job: _Append) -> None:
        if job.file not in self._files:
            self._files[job.file] = _open(self._folder / job.file)
        file = self._files[job.file]
        if file.write(job.line) != len(job.line):
            raise OSError(f"{job.file} was not written whole")
        if job.durable:
            os.fsync(file.fileno())

    def _sync(self) -> None:
        """Force all to disk; trajectories are closed, since a flush comes before and after each motion."""
        for file in self._files.values():
            os.fsync(file.fileno())
        self._close_files()

    def _close_files(self) -> None:
        for file in self._files.values():
            file.close()
        self._files.clear()


def trajectory_file(permit_id: str) -> str:
    """Name of a motion's trajectory file in the journal's folder."""
    return f"trajectory-{permit_id}.jsonl"


def read_lines(path: Path) -> list[dict[str, Any]]:
    """Lines of a journal or trajectory; one that a crash or a full disk cut short is left out."""
    if not path.exists():
        return []
    return [content for line in path.read_bytes().splitlines() if (content := _parse(line)) is not None]


def _parse(line: bytes) -> dict[str, Any] | None:
    try:
        content = json.loads(line)
    except ValueError:
        return None
    return content if isinstance(content, dict) else None


def _open(path: Path) -> FileIO:
    """Open to append; a last line that was cut short is ended first, so that the next one stays whole."""
    path.parent.mkdir(parents=True, exist_ok=True)
    file = FileIO(path, "a+b")
    end = file.seek(0, os.SEEK_END)
    file.seek(max(end - 1, 0))
    if end and file.read(1) != b"\n":
        file.write(b"\n")
    return file


def _sample(reading: ArmState) -> dict[str, Any]:
    return {
        "controller_time_s": reading.controller_time_s,
        "received_at_s": reading.received_at_s,
        "joints_rad": plain(reading.joints_rad),
        "base_from_tcp": plain(reading.base_from_tcp),
        "tcp_speed_mm_s": reading.tcp_speed_mm_s,
        "safety": reading.safety,
    }


def _line(content: Mapping[str, Any]) -> bytes:
    return json.dumps(content, separators=(",", ":")).encode() + b"\n"

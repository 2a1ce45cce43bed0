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
from robot.guard.lines import plain

EVENTS_FILE = "guard.jsonl"


@dataclass(frozen=True, slots=True)
class _Append:
    file: str
    line: bytes
    durable: bool


class Journal:
    """Appends to files of a folder; `fault` is what could not be written, or None."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._jobs: SimpleQueue[_Append | Signal | None] = SimpleQueue()
        self._files: dict[str, FileIO] = {}
        self._thread = Thread(target=self._work, name="journal", daemon=True)
        self._thread.start()
        self.fault: str | None = None

    def record(self, event: str, at_s: float, content: Mapping[str, Any]) -> None:
        """Append an event, forced to disk; returns at once."""
        line = _line({"event": event, "at_s": at_s, **content})
        self._jobs.put(_Append(EVENTS_FILE, line, durable=True))

    def sample(self, permit_id: str, reading: ArmState) -> None:
        """Append a reading to a motion's trajectory; returns at once."""
        self._jobs.put(_Append(trajectory_file(permit_id), _line(_sample(reading)), durable=False))

    def flush(self, timeout_s: float) -> bool:
        """Wait until all so far is on the disk; False if something is not, or not in time."""
        done = Signal()
        self._jobs.put(done)
        return done.wait(timeout_s) and self.fault is None

    def close(self) -> None:
        """Write what is left and end the thread."""
        self._jobs.put(None)
        self._thread.join(timeout=2.0)

    def _work(self) -> None:
        while (job := self._jobs.get()) is not None:
            try:
                self._do(job)
                self.fault = None
            except OSError as error:
                self.fault = str(error)
            if isinstance(job, Signal):
                job.set()
        self._close_files()

    def _do(self, job: _Append | Signal) -> None:
        if isinstance(job, Signal):
            self._sync()
            return
        if job.file not in self._files:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._files[job.file] = FileIO(self._folder / job.file, "ab")
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
    """Lines of a journal or trajectory; one that a crash cut short is left out."""
    if not path.exists():
        return []
    whole = path.read_bytes().splitlines(keepends=True)
    return [json.loads(line) for line in whole if line.endswith(b"\n")]


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
    return json.dumps(content, separators=(",", ":"), default=plain).encode() + b"\n"

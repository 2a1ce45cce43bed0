"""Trials of the evidence: each some thousand executions in a process of their own."""

import json
import signal
import struct
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import Any

from benchmarks.evidence.item import Trial
from benchmarks.fuzz.targets import TARGETS


def trials(name: str, _inputs: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Trials of the target of this name."""
    of_a_trial = TARGETS[name].of_a_trial
    for number in numbers:
        yield {"number": number} | _trial(name, number * of_a_trial, of_a_trial)


def _trial(name: str, first: int, count: int) -> Trial:
    """All executions from `first` on; behind one that ended its process another goes on."""
    kinds, found, at = Counter[str](), [], first
    while at < first + count:
        ran = _ran(name, at, first + count - at)
        if "ended" in ran:  # what came before it is done again, to be counted
            before = _ran(name, at, ran["number"] - at) if ran["number"] > at else {"kinds": {}, "found": []}
            ran = {
                "kinds": Counter(before["kinds"]) + Counter([ran["ended"]]),
                "found": [*before["found"], [ran["number"], ran["ended"]]],
            }
        kinds.update(ran["kinds"])
        found += ran["found"]
        at = first + kinds.total()
    return {"kinds": dict(kinds), "bad": len(found), "found": found}


def _ran(name: str, first: int, count: int) -> dict[str, Any]:
    """What a process says, or the number in whose execution a signal ended it."""
    with NamedTemporaryFile() as file:
        file.write(bytes(8))
        file.flush()
        command = [sys.executable, "-m", "benchmarks.fuzz.child", name, str(first), str(count), file.name]
        run = subprocess.run(command, stdout=subprocess.PIPE, check=False)
        if run.returncode == 0:
            answer: dict[str, Any] = json.loads(run.stdout)
            return answer
        if run.returncode > 0:
            raise RuntimeError(f"the process did not work: {' '.join(command)}")
        (number,) = struct.unpack("<q", Path(file.name).read_bytes())
        ended = signal.Signals(-run.returncode)
        return {"number": number, "ended": "hung" if ended is signal.SIGPROF else f"crashed by {ended.name}"}

"""How soon a stop is on the wire while both cores burn and images are registered.

    python -m benchmarks.stop --folder FOLDER [--count N] [--kinds KIND ...] [--idle]

Kinds: heartbeat (lost link: beyond the 200 ms of silence), release, stop (by HTTP, every role, every state),
kill_service, kill_guard (to its parent's stop or the controller's watchdog), nuisance (held motions of 2 mm behind a
network that jitters by 40 ms: how many do not arrive; half as many as of the others). The controller is a process of
its own whose log, on the monotonic clock of the machine, is the witness. Controller, guard, network and the clients
run before the load where the system lets them. Every trial is a line of FOLDER/KIND.jsonl, and a run goes on where the
last one ended; FOLDER/summary.json has the figures. Exit status 1 where a limit is not held. --idle: without load.
"""

import argparse
import json
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, nullcontext, suppress
from pathlib import Path

from benchmarks.stop.guard_room import GuardRoom
from benchmarks.stop.load import Load
from benchmarks.stop.results import Kept, Limits, Trial, histogram, summary
from benchmarks.stop.service_room import ServiceRoom

LIMITS = {
    "heartbeat": Limits(p99_ms=25.0, largest_ms=50.0),
    "release": Limits(p99_ms=20.0),
    "stop": Limits(p99_ms=50.0),
    "kill_service": Limits(p99_ms=25.0),
    "kill_guard": Limits(largest_ms=440.0),  # the watchdog's 0.4 s and a tenth
    "nuisance": Limits(bad=1),
}
# Kinds in which a tablet's clock counts: it shares no processor with the service. The others start processes of the
# service during a trial, which would inherit the precedence.
_TABLET = ("release", "stop", "nuisance")
_PRIORITY = -10
_TELL_EVERY = 50
_ROOMS_LAST = 200  # trials: a new room then, so that no log grows without end


@contextmanager
def room_of(kind: str) -> Iterator[Callable[[int], Trial]]:
    """A trial of this kind, by its number."""
    with tempfile.TemporaryDirectory(prefix="coaxial-stop-") as folder:
        place = Path(folder) / "data"
        room = (
            GuardRoom(place) if kind in ("heartbeat", "kill_guard") else ServiceRoom(place, jitters=kind == "nuisance")
        )
        with room:
            yield getattr(room, kind)


@contextmanager
def precedence(taken: bool) -> Iterator[None]:
    """This thread and those that it starts run before others, where the system lets them."""
    before = os.getpriority(os.PRIO_PROCESS, 0)
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, _PRIORITY if taken else before)
    yield
    with suppress(PermissionError):
        os.setpriority(os.PRIO_PROCESS, 0, before)


def run(kept: Kept, count: int) -> None:
    """As many trials as are missing."""
    while len(kept.trials) < count:
        with room_of(kept.kind) as trial, precedence(kept.kind in _TABLET):
            for number in range(len(kept.trials), min(count, len(kept.trials) + _ROOMS_LAST)):
                began_s = time.monotonic()
                kept.add(trial(number))
                if (number + 1) % _TELL_EVERY == 0:
                    newest = kept.trials[-1].latency_ms
                    told = "" if newest is None else f", newest {newest:.1f} ms"
                    print(f"{kept.kind}: {number + 1} of {count}{told}, {time.monotonic() - began_s:.1f} s", flush=True)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--kinds", nargs="+", choices=LIMITS, default=list(LIMITS))
    parser.add_argument("--idle", action="store_true")
    chosen = parser.parse_args()
    figures = []
    with nullcontext() if chosen.idle else Load():
        for kind in chosen.kinds:
            kept = Kept(chosen.folder, kind)
            run(kept, max(1, chosen.count // 2) if kind == "nuisance" else chosen.count)
            figures.append(summary(kept, LIMITS[kind]))
            print(json.dumps(figures[-1]), histogram(kept), sep="\n", flush=True)
    (chosen.folder / "summary.json").write_text(json.dumps(figures, indent=1) + "\n")
    return 0 if all(figure["holds"] for figure in figures) else 1


if __name__ == "__main__":
    sys.exit(main())

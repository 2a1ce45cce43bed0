"""How soon a stop is on the wire while both cores burn and images are registered.

    python -m benchmarks.stop --folder FOLDER [--count N] [--kinds KIND ...] [--minutes M] [--rooms R]
                              [--idle | --busy COMMAND ...]

Kinds: heartbeat (lost link: beyond the 200 ms of silence), release, stop (by HTTP, every role), stop_elsewhere (in the
states that it takes images to reach, for which the load pauses; a tenth as many), kill_service (the next one forked
from a process that has imported everything, every twentieth started whole; the figures tell them apart), kill_guard (to
its parent's stop; every other time to the controller's watchdog alone), nuisance (held motions of 12 mm behind a
network that jitters by 40 ms: how many do not arrive; half as many as of the others). The controller is a process of
its own whose log, on the monotonic clock of the machine, is the witness. Controller, network and the clients run before
the load where the system lets them; it pauses while a service starts. Every trial is a line of FOLDER/KIND.jsonl, and a
run goes on where the last one ended, however it ended; FOLDER/summary.json has the figures of all that are there. Exit
status 1 where a limit is missed. --minutes: begin no trial after so long. --idle: no load. --busy, once for each core:
a calculation that outlasts the run, in place of the burners; it is stopped amid whatever it does.
--rooms: so many side by side beside one load, which then never pauses; a kind in each, taken in turn, with a folder of
its own; one that is named twice is divided between two. They disturb one another, as a room by itself is not disturbed.
"""

import argparse
import gc
import json
import shlex
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from benchmarks.kept import at_least_one, results_folder
from benchmarks.stop.guard_room import GuardRoom
from benchmarks.stop.load import Load
from benchmarks.stop.results import Kept, Limits, Trial, Verdict, histogram, summary
from benchmarks.stop.service_room import ServiceRoom

LIMITS = {
    "heartbeat": Limits(p99_ms=25.0, largest_ms=50.0),
    "release": Limits(p99_ms=20.0),
    "stop": Limits(p99_ms=50.0),
    "stop_elsewhere": Limits(p99_ms=50.0),
    "kill_service": Limits(p99_ms=25.0),
    "kill_guard": Limits(largest_ms=440.0),  # the watchdog's 0.4 s and a tenth
    "nuisance": Limits(bad_share=1e-3),
}
_FEWER = {"nuisance": 2, "stop_elsewhere": 10}  # one trial for so many of the others
# The longest first, the two that start processes anew divided: so rooms side by side end at about the same time.
_ALL = 2 * ["kill_service"] + 2 * ["kill_guard"] + ["heartbeat", "nuisance", "release", "stop_elsewhere", "stop"]
_TELL_EVERY_S = 20.0
_LOOK_S = 0.5
_ROOMS_LAST = 200  # trials: a new room then, so that no log grows without end


@dataclass(slots=True)
class Progress:
    """Tells how far a kind is, and how long the rest will take at the pace of this run."""

    kept: Kept
    wanted: int
    began_s: float
    before: int
    told_s: float = 0.0

    def tell(self) -> None:
        """Print a line, now and then."""
        now_s, done = time.monotonic(), len(self.kept.trials)
        if now_s - self.told_s < _TELL_EVERY_S or done == self.before:
            return
        self.told_s = now_s
        left_min = (self.wanted - done) * (now_s - self.began_s) / (done - self.before) / 60.0
        print(f"{self.kept.kind}: {done} of {self.wanted}, {left_min:.0f} min left", flush=True)


@contextmanager
def room_of(kind: str, load: Load) -> Iterator[Callable[[int], Trial]]:
    """A trial of this kind, by its number."""
    with tempfile.TemporaryDirectory(prefix="coaxial-stop-") as folder:
        place = Path(folder) / "data"
        if kind in ("heartbeat", "kill_guard"):
            room: GuardRoom | ServiceRoom = GuardRoom(place, load)
        else:
            room = ServiceRoom(place, load, jitters=kind == "nuisance", forks=kind == "kill_service")
        with room as entered:
            yield getattr(entered, kind)


def run(kept: Kept, wanted: int, load: Load, end_s: float) -> None:
    """As many trials as are missing, until the end of the time."""
    progress = Progress(kept, wanted, time.monotonic(), len(kept.trials))
    while len(kept.trials) < wanted and time.monotonic() < end_s:
        with room_of(kept.kind, load) as trial:
            for _ in range(_ROOMS_LAST):
                if len(kept.trials) >= wanted or time.monotonic() > end_s:
                    break
                kept.add(trial(len(kept.trials)))
                progress.tell()


def run_side_by_side(chosen: argparse.Namespace, end_s: float) -> None:
    """A process for each kind, or each part of one, so many at a time."""
    with ExitStack() as started:
        running: list[subprocess.Popen[bytes]] = []
        for number, kind in enumerate(chosen.kinds):
            while len(running) == chosen.rooms:
                time.sleep(_LOOK_S)
                running = [process for process in running if process.poll() is None]
            command = [sys.executable, "-m", "benchmarks.stop", "--idle", "--kinds", kind]
            command += ["--count", str(-(-chosen.count // chosen.kinds.count(kind)))]
            command += ["--minutes", str((end_s - time.monotonic()) / 60.0)]
            part = chosen.kinds[:number].count(kind) + 1
            process = subprocess.Popen([*command, "--folder", str(chosen.folder / f"{kind}-{part}")])
            started.enter_context(process)
            started.callback(process.terminate)
            running.append(process)
        for process in running:
            process.wait()


def report(folder: Path) -> list[Verdict]:
    """Print and keep the figures of every kind that has trials; the verdicts on their limits."""
    figures = []
    for kind, limits in LIMITS.items():
        kept = Kept(folder, kind)
        if kept.trials:
            figures.append(summary(kept, limits))
            print(json.dumps(figures[-1], indent=1), histogram(kept), sep="\n", flush=True)
    (folder / "summary.json").write_text(json.dumps(figures, indent=1) + "\n")
    return [verdict for one in figures for verdict in one["verdicts"].values()]


def main() -> int:
    """Run what is asked for; exit status 1 where a limit is missed."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--folder", type=results_folder, required=True)
    parser.add_argument("--count", type=at_least_one, default=2000)
    parser.add_argument("--kinds", nargs="+", choices=LIMITS, default=_ALL)
    parser.add_argument("--minutes", type=float, default=float("inf"))
    parser.add_argument("--rooms", type=at_least_one, default=1)
    by = parser.add_mutually_exclusive_group()
    by.add_argument("--idle", action="store_true")
    by.add_argument("--busy", type=shlex.split, action="append", default=[], metavar="COMMAND")
    chosen = parser.parse_args()
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))  # by the ways of every process that was started
    end_s = time.monotonic() + 60.0 * chosen.minutes
    gc.freeze()  # a tablet has no such heap to search, nor have the other clients
    with Load(wanted=not chosen.idle, busy=chosen.busy) as load:
        if chosen.rooms > 1:
            run_side_by_side(chosen, end_s)
        for kind in chosen.kinds if chosen.rooms == 1 else ():
            run(Kept(chosen.folder, kind), max(1, chosen.count // _FEWER.get(kind, 1)), load, end_s)
    return 1 if Verdict.MISSED in report(chosen.folder) else 0


if __name__ == "__main__":
    sys.exit(main())

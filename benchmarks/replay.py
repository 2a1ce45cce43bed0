"""How fast past cases are replayed, and how near that comes to being proportional to the workers.

Records CASES cases of one target each (two images, five results), then runs `coaxial audit replay --all` over them with
1, 2, ... WORKERS processes. Wall time depends on what else the machine does; beside it stands processor time: that of
all processes for one result, which must not grow with the workers, and the share of the reading process, which is what
one machine cannot divide.
"""

import argparse
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

from argon2 import PasswordHasher

from benchmarks import recorded_cases
from benchmarks.computed_results import compute
from benchmarks.kept import at_least_one
from service.auth.permissions import Role
from service.auth.users import UserStore
from service.database.current import current_database
from service.settings import Settings
from workflow.states import State

_RESULTS = 5  # of each case
_REPLAY = [sys.executable, "-c", "from service.cli.main import main; main()", "audit", "replay", "--all"]


@dataclass(frozen=True)
class Run:
    """One replay of the archive."""

    workers: int
    wall_s: float
    processor_s: float


def record_archive(folder: Path, cases: int) -> None:
    """So many closed cases; images and results are computed once."""
    settings = Settings(data_folder=folder, min_free_bytes=0)
    results = compute(settings)
    with current_database(settings) as database:
        surgeon = UserStore(database, PasswordHasher(1, 8, 1)).add("anna", Role.SURGEON, "correct horse", "2468")
        for number in range(1, cases + 1):
            recorded_cases.record(database, settings, surgeon.id, results, State.CLOSED)
            if number % 50 == 0:
                print(f"{number} cases recorded", file=sys.stderr, flush=True)


def replay(folder: Path, workers: int) -> Run:
    """Replay all of it; raises CalledProcessError where anything differs."""
    before, started_s = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    command = [*_REPLAY, "--workers", str(workers), "--data-folder", str(folder)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    wall_s, after = time.monotonic() - started_s, resource.getrusage(resource.RUSAGE_CHILDREN)
    used_s = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return Run(workers, wall_s, used_s)


def reading_s(folder: Path) -> float:
    """Processor time of reading every case as a replay does."""
    from service.cases import store
    from service.replay.reading import read_input

    settings, started_s = Settings(data_folder=folder, min_free_bytes=0), time.process_time()
    with current_database(settings) as database, database.read() as connection:
        for case in store.list_cases(connection):
            read_input(connection, case.id, settings)
    return time.process_time() - started_s


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", type=at_least_one, default=40, help="cases to record (default 40)")
    parser.add_argument(
        "--workers", type=at_least_one, default=os.cpu_count() or 1, help="the most (default: the processors)"
    )
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        record_archive(folder, options.cases)
        results, read_s = options.cases * _RESULTS, reading_s(folder)
        print(f"{options.cases} cases, {results} results, {os.cpu_count()} processors, load {os.getloadavg()[0]:.1f}")
        print("workers  wall s  results/s  speed-up  processor s a result")
        first: Run | None = None
        for workers in range(1, options.workers + 1):
            run = replay(folder, workers)
            first = first or run
            rate, speed_up = results / run.wall_s, first.wall_s / run.wall_s
            each_s = run.processor_s / results
            print(f"{workers:7} {run.wall_s:7.1f} {rate:10.2f} {speed_up:9.2f} {each_s:21.3f}", flush=True)
        print(f"reading: {read_s:.2f} s of processor time, {read_s / first.processor_s:.1%} of it all: not divided")


if __name__ == "__main__":
    main()

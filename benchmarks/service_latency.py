"""How long the service takes from an image to its registration on a tablet while every core is busy.

    python benchmarks/service_latency.py [--count N] [--pedicle NAME] [--folder FOLDER]

The real service, the simulated room and its C-arm run as processes of their own on loopback, as in `coaxial demo`;
besides, one process for each core computes all the time. Each exposure is of the guide in a view of its own. Counted is
the time from when the image was received, which is written with its commit, to the event of its registration (or
refusal) on a client that follows the case; both are told by this machine's clock. FOLDER keeps a line for each result,
and a run goes on where the last one ended. Exit status 1 where the limit is missed.
"""

import argparse
import json
import multiprocessing
import os
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path

import numpy as np

from benchmarks.kept import results_folder
from coaxial_client import Case, NoAnswer
from simulator.demo.imaging import turn_carm
from simulator.demo.patience import HELD, leave_hold, patiently
from simulator.demo.procedure import open_case
from simulator.demo.stage import Stage, open_stage
from simulator.demo.targeting import bring_guide_in
from simulator.demo.team import Team
from simulator.demo.telling import Teller, open_console
from simulator.demo.watching import Json, await_event

GREATEST_P95_S = 1.0
_RESULTS = ("registration_completed", "registration_refused")
_RESULT_WITHIN_S = 120.0
_SHOWN_WITHIN_S = 10.0


class Tablet:
    """A client that follows a case: when it was sent each event, by its sequence."""

    def __init__(self, case: Case) -> None:
        self._case = case
        self._shown_at_s: dict[int, float] = {}
        self._news = threading.Condition()
        threading.Thread(target=self._follow, daemon=True).start()

    def _follow(self) -> None:
        try:
            for event in self._case.events(int(self._case.status()["sequence"])):
                with self._news:
                    self._shown_at_s[int(event["sequence"])] = time.time()
                    self._news.notify_all()
        except NoAnswer:  # the service ends before its clients
            return

    def shown_at_s(self, sequence: int) -> float:
        """When an event came; TimeoutError if it does not."""
        with self._news:
            if not self._news.wait_for(lambda: sequence in self._shown_at_s, _SHOWN_WITHIN_S):
                raise TimeoutError(f"event {sequence} was not sent within {_SHOWN_WITHIN_S:g} s")
            return self._shown_at_s[sequence]


def _compute() -> None:
    while True:
        np.linalg.svd(np.random.default_rng(0).normal(size=(60, 60)))


@contextmanager
def busy_cores() -> Iterator[None]:
    """A process for each core that computes all the time."""
    processes = [multiprocessing.Process(target=_compute, daemon=True) for _ in os.sched_getaffinity(0)]
    for process in processes:
        process.start()
    try:
        yield
    finally:
        for process in processes:
            process.terminate()
            process.join()


def registered(team: Team, tablet: Tablet, pedicle: str) -> Json:
    """One image in a view of its own, and how long its result took."""
    turn_carm(team, pedicle)
    event = patiently(team, lambda: _exposed(team))
    image = team.surgeon.room.image(event["data"]["image_id"])
    received_at_s = datetime.fromisoformat(image["received_at"]).timestamp()
    latency_s = tablet.shown_at_s(int(event["sequence"])) - received_at_s
    if event["state"] == HELD:
        leave_hold(team)
    return {
        "latency_s": round(latency_s, 4),
        "result": event["trigger"],
        "register_ms": event["data"].get("elapsed_ms"),
        "reason": (event["data"].get("reason") or {}).get("code"),
    }


def _exposed(team: Team) -> Json:
    after = int(team.operator.status()["sequence"])
    team.operator.command("exposure-requested")
    team.door.expose()
    return await_event(team.surgeon, after, _RESULTS, _RESULT_WITHIN_S)


def measure(stage: Stage, pedicle: str, count: int, results: Path, teller: Teller) -> None:
    """So many results, each written as soon as it is there."""
    chosen = [one for one in stage.door.pedicles() if one.name == pedicle]
    with stage.sign_in("surgeon") as surgeon, stage.sign_in("operator") as operator, stage.sign_in("surgeon") as other:
        team = open_case(stage, surgeon, operator, chosen, teller)
        bring_guide_in(team, pedicle)
        tablet = Tablet(other.case(team.surgeon.id))
        with busy_cores(), results.open("a") as file:
            for number in range(1, count + 1):
                result = registered(team, tablet, pedicle)
                file.write(json.dumps(result) + "\n")
                file.flush()
                teller.tell(f"{number} of {count}: {result['latency_s']:.3f} s, {result['reason'] or 'registered'}")


def judged(results: list[Json]) -> bool:
    """Print the figures; whether the limit holds."""
    latency_s = np.array([one["latency_s"] for one in results])
    register_s = np.array([one["register_ms"] for one in results if one["register_ms"] is not None]) / 1e3
    refused = sum(one["reason"] is not None for one in results)
    middle, most = np.percentile(latency_s, (50, 95))
    print(f"{len(results)} images, {refused} refused, {len(os.sched_getaffinity(0))} cores busy")
    figures = f"p50 {middle:.3f} s, p95 {most:.3f} s, max {latency_s.max():.3f} s"
    print(f"from the image's receipt to its result on a tablet: {figures}")
    if len(register_s):
        print(f"of it in register: p50 {np.median(register_s):.3f} s, p95 {np.percentile(register_s, 95):.3f} s")
    held = bool(most <= GREATEST_P95_S)
    print(f"p95 at most {GREATEST_P95_S:g} s" + ("" if held else f"  MISSED by {most - GREATEST_P95_S:.3f} s"))
    return held


def main() -> None:
    """Measure what is missing, then print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=100, help="images (default 100)")
    parser.add_argument("--pedicle", default="L3-left", help="in whose view the images are taken (default L3-left)")
    parser.add_argument("--folder", type=results_folder, help="keeps the results (default: a new temporary one)")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(options.folder or temporary)
        results = folder / "results.jsonl"
        done = len(results.read_text().splitlines()) if results.exists() else 0
        if done < options.count:
            teller = Teller(open_console())
            with open_stage(Path(temporary) / "stage", 0, None, teller) as stage:
                measure(stage, options.pedicle, options.count - done, results, teller)
        sys.exit(0 if judged([json.loads(line) for line in results.read_text().splitlines()]) else 1)


if __name__ == "__main__":
    main()

"""What a command takes while fifty screens follow the case and images are registered.

    python benchmarks/load.py [--observers 50] [--rate 10] [--seconds 60]

The real service, the simulated room and its C-arm run as processes of their own on loopback, as in `coaxial demo`. Each
observer is a session and a stream of server-sent events of its own. Commands state the guide empty, at a steady rate
whatever the earlier ones take, and are timed from when each was due. Images are exposed and registered one behind the
other meanwhile. Every observer must have been sent every event once, in order. Exit status 1 where a limit is missed.
"""

import argparse
import asyncio
import json
import multiprocessing
import os
import sys
import tempfile
import threading
import time
from multiprocessing.connection import Connection
from pathlib import Path

import httpx
import numpy as np

from benchmarks.service_latency import Tablet, registered
from coaxial_client import Case
from simulator.demo.procedure import open_case
from simulator.demo.stage import Stage, open_stage
from simulator.demo.targeting import bring_guide_in
from simulator.demo.team import Team
from simulator.demo.telling import Teller, open_console

GREATEST_P99_MS = 60.0
_LAST_EVENTS_S = 5.0  # the observers are sent the last events within it
_PEDICLE = "L3-left"


def watch(url: str, tokens: list[str], after: int, told: Connection) -> None:
    """Follow a case with one stream for each token until told to end; then tell the events that each was sent."""
    asyncio.run(_watch(url, tokens, after, told))


async def _watch(url: str, tokens: list[str], after: int, told: Connection) -> None:
    sent: list[list[int]] = [[] for _ in tokens]
    async with httpx.AsyncClient(timeout=None, limits=httpx.Limits(max_connections=None), trust_env=False) as client:
        streams = [
            asyncio.create_task(_follow(client, url, token, after, sequences))
            for token, sequences in zip(tokens, sent, strict=True)
        ]
        await asyncio.to_thread(told.recv)
        for stream in streams:
            stream.cancel()
        await asyncio.gather(*streams, return_exceptions=True)
    told.send(sent)


async def _follow(client: httpx.AsyncClient, url: str, token: str, after: int, sequences: list[int]) -> None:
    headers = {"Authorization": f"Bearer {token}", "Last-Event-ID": str(after)}
    async with client.stream("GET", url, headers=headers) as response:
        response.raise_for_status()
        async for line in response.aiter_lines():
            if line.startswith("data:"):
                sequences.append(json.loads(line.removeprefix("data:"))["sequence"])


class Commands:
    """Commands at a steady rate, and how long each took from when it was due."""

    def __init__(self, case: Case, rate_hz: float) -> None:
        self._case = case
        self._every_s = 1.0 / rate_hz
        self._over = threading.Event()
        self.took_ms: list[float] = []
        self._thread = threading.Thread(target=self._send)

    def __enter__(self) -> "Commands":
        self._thread.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._over.set()
        self._thread.join()

    def _send(self) -> None:
        due_s = time.perf_counter()
        while not self._over.wait(max(0.0, due_s - time.perf_counter())):
            self._case.command("guide-state-stated", guide="empty")
            self.took_ms.append((time.perf_counter() - due_s) * 1e3)
            due_s += self._every_s


def measure(stage: Stage, options: argparse.Namespace, teller: Teller) -> tuple[list[float], int, list[list[int]], int]:
    """How long the commands took, images registered, what every observer was sent, and how many events there were."""
    chosen = [one for one in stage.door.pedicles() if one.name == _PEDICLE]
    with stage.sign_in("surgeon") as surgeon, stage.sign_in("operator") as operator, stage.sign_in("surgeon") as other:
        team = open_case(stage, surgeon, operator, chosen, teller)
        bring_guide_in(team, _PEDICLE)
        case = other.case(team.surgeon.id)
        first = int(case.status()["sequence"])
        here, there = multiprocessing.Pipe()
        tokens = [_token(stage) for _ in range(options.observers)]
        address = f"{stage.url}/api/cases/{case.id}/events"
        observers = multiprocessing.get_context("spawn").Process(target=watch, args=(address, tokens, first, there))
        observers.start()
        with Commands(case, options.rate) as commands:
            images = _expose(team, Tablet(case), options.seconds, teller)
        newest = int(case.status()["sequence"])
        time.sleep(_LAST_EVENTS_S)
        here.send("end")
        sent = here.recv()
        observers.join()
        return commands.took_ms, images, sent, newest - first


def _token(stage: Stage) -> str:
    person = stage.people["surgeon"]
    answer = httpx.post(f"{stage.url}/api/session", json={"name": person.name, "password": person.password})
    answer.raise_for_status()
    return str(answer.json()["token"])


def _expose(team: Team, tablet: Tablet, seconds: float, teller: Teller) -> int:
    end_s, images = time.monotonic() + seconds, 0
    while time.monotonic() < end_s:
        result = registered(team, tablet, _PEDICLE)
        images += 1
        teller.tell(f"image {images}: {result['latency_s']:.3f} s, {result['reason'] or 'registered'}")
    return images


def judged(took_ms: list[float], images: int, sent: list[list[int]], events: int) -> bool:
    """Print the figures; whether the limits hold."""
    middle, most = np.percentile(took_ms, (50, 99))
    whole = sum(len(one) == events and one == sorted(set(one)) for one in sent)
    print(f"{len(took_ms)} commands beside {images} images, {len(os.sched_getaffinity(0))} cores")
    print(f"a command: p50 {middle:.1f} ms, p99 {most:.1f} ms, max {max(took_ms):.1f} ms")
    print(f"{whole} of {len(sent)} observers were sent each of the {events} events once and in order")
    held = bool(most <= GREATEST_P99_MS)
    print(f"p99 at most {GREATEST_P99_MS:g} ms" + ("" if held else f"  MISSED by {most - GREATEST_P99_MS:.1f} ms"))
    return held and whole == len(sent)


def main() -> None:
    """Measure, then print the figures."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--observers", type=int, default=50)
    parser.add_argument("--rate", type=float, default=10.0, help="commands a second (default 10)")
    parser.add_argument("--seconds", type=float, default=60.0)
    options = parser.parse_args()
    teller = Teller(open_console())
    with tempfile.TemporaryDirectory() as temporary, open_stage(Path(temporary) / "stage", 0, None, teller) as stage:
        figures = measure(stage, options, teller)
    sys.exit(0 if judged(*figures) else 1)


if __name__ == "__main__":
    main()

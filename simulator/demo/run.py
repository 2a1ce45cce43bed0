"""A run from an empty folder to the table; whatever it started is ended, however it goes."""

import signal
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

import httpx
from rich.console import Console

from coaxial_client import NoAnswer, Refused
from simulator.demo.door_client import PlannedPedicle
from simulator.demo.failure import DemoFailed, explain
from simulator.demo.procedure import run_case
from simulator.demo.results import TargetResult
from simulator.demo.stage import Stage, open_stage
from simulator.demo.table import result_table
from simulator.demo.telling import Teller, open_console

_DONE, _FAILED, _INTERRUPTED = 0, 1, 130
_ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_FOUR = ("L3-left", "L3-right", "L4-left", "L4-right")
_LOOK_EVERY_S = 0.5
_GONE_WITHIN_S = 1.0  # a connection breaks before its process has ended


@dataclass(frozen=True, slots=True)
class Wanted:
    """What was asked for at the command line."""

    pedicles: tuple[str, ...]  # none: those of the default
    data: Path | None
    port: int
    stay: bool
    faults: tuple[str, ...]
    truth: Path | None


def run(wanted: Wanted) -> int:
    """The exit status."""
    for ending in _ENDINGS:
        signal.signal(ending, _interrupt)
    folder = Path(tempfile.mkdtemp(prefix="coaxial-demo-")) if wanted.data is None else wanted.data.absolute()
    console = open_console()
    teller = Teller(console)
    teller.about = "room"
    try:
        with open_stage(folder, wanted.port, wanted.truth, teller) as stage:
            _stay(stage, console) if wanted.stay else _place_all(stage, wanted, teller)
    except (DemoFailed, Refused, NoAnswer, httpx.HTTPError, TimeoutError) as error:
        _say_failed(f"{teller.about}: {explain(error)}. Logs: {folder}")
        return _FAILED
    except KeyboardInterrupt:
        console.print("interrupted; everything that was started has been ended")
        return _DONE if wanted.stay else _INTERRUPTED
    return _DONE


def _interrupt(_number: int, _frame: FrameType | None) -> None:
    """Once: a second signal must not cut the ending short."""
    for ending in _ENDINGS:
        signal.signal(ending, signal.SIG_IGN)
    raise KeyboardInterrupt


def _place_all(stage: Stage, wanted: Wanted, teller: Teller) -> None:
    results: list[TargetResult] = []
    pedicles = choose(stage.door.pedicles(), wanted.pedicles)
    for fault in wanted.faults:
        stage.door.inject(fault)
        teller.tell(f"fault injected: {fault}")
    try:
        for result in run_case(stage, pedicles, teller):
            results.append(result)
    except (NoAnswer, httpx.HTTPError, TimeoutError):
        stage.check_alive(_GONE_WITHIN_S)  # a process that is gone explains more than an answer that did not come
        raise
    finally:
        if results:
            teller.console.print(result_table(results))
    teller.console.print(
        f"{len(results)} targets placed in {teller.elapsed_s():.0f} s, corrective motions: "
        f"{sum(result.corrections for result in results)}. Service {stage.url} (ended now); "
        f"data and logs in {stage.folder}",
        soft_wrap=True,
    )


def choose(planned: Sequence[PlannedPedicle], names: Sequence[str]) -> list[PlannedPedicle]:
    """Those of the room that were asked for, else the usual ones; DemoFailed where it has no such one."""
    by_name = {pedicle.name: pedicle for pedicle in planned}
    names = names or (_FOUR if by_name.keys() >= set(_FOUR) else tuple(by_name))
    unknown = [name for name in names if name not in by_name]
    if unknown:
        raise DemoFailed("pedicle_unknown", f"{', '.join(unknown)}; there are {', '.join(by_name)}")
    return [by_name[name] for name in names]


def _stay(stage: Stage, console: Console) -> None:
    """Until Ctrl-C, or until a process ends by itself."""
    console.print(f"\nservice  {stage.url}   interface description at {stage.url}/api/openapi.json", soft_wrap=True)
    console.print(f"room     {stage.door.url}   planned pedicles at {stage.door.url}/pedicles", soft_wrap=True)
    for person in stage.people.values():
        console.print(f"sign-in  {person.name}   password {person.password}   PIN {person.pin}", markup=False)
    console.print(f"data and logs in {stage.folder}; Ctrl-C ends all", soft_wrap=True)
    while True:
        time.sleep(_LOOK_EVERY_S)
        stage.check_alive()


def _say_failed(text: str) -> None:
    Console(stderr=True, highlight=False).print(f"failed: {text}", markup=False, soft_wrap=True)

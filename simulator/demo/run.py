"""A run from an empty folder to the table; whatever it started is ended, however it goes."""

import signal
import tempfile
import time
from pathlib import Path
from types import FrameType

import httpx
from rich.console import Console

from coaxial_client import NoAnswer, Refused
from simulator.demo.failure import DemoFailed, NothingStartedError, explain
from simulator.demo.procedure import run_case
from simulator.demo.results import TargetResult
from simulator.demo.stage import Stage, open_stage
from simulator.demo.table import result_table
from simulator.demo.telling import Teller, open_console
from simulator.demo.wanted import Wanted, check, chosen

_DONE, _FAILED, _INTERRUPTED = 0, 1, 130
_ENDINGS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)
_LOOK_EVERY_S = 0.5
_GONE_WITHIN_S = 1.0  # a connection breaks before its process has ended


def run(wanted: Wanted) -> int:
    """The exit status."""
    for ending in _ENDINGS:
        signal.signal(ending, _interrupt)
    console = open_console()
    teller = Teller(console)
    teller.about = "room"
    try:
        check(wanted)
        folder = _folder(wanted.data)
        with open_stage(folder, wanted.port, wanted.truth, teller) as stage:
            _stay(stage, console) if wanted.stay else _place_all(stage, wanted, teller)
    except NothingStartedError as error:
        _say_failed(f"{teller.about}: {explain(error)}")
        return _FAILED
    except (DemoFailed, Refused, NoAnswer, httpx.HTTPError, OSError) as error:
        _say_failed(f"{teller.about}: {explain(error)}. Logs: {folder}")
        return _FAILED
    except KeyboardInterrupt:
        console.print("interrupted; everything that was started has been ended")
        return _DONE if wanted.stay else _INTERRUPTED
    return _DONE


def _folder(named: Path | None) -> Path:
    if named is not None:
        return named.absolute()
    try:
        return Path(tempfile.mkdtemp(prefix="coaxial-demo-"))
    except OSError as error:
        raise NothingStartedError("folder_refused", f"no temporary folder: {error.strerror}") from error


def _interrupt(_number: int, _frame: FrameType | None) -> None:
    """Once: a second signal must not cut the ending short."""
    for ending in _ENDINGS:
        signal.signal(ending, signal.SIG_IGN)
    raise KeyboardInterrupt


def _place_all(stage: Stage, wanted: Wanted, teller: Teller) -> None:
    results: list[TargetResult] = []
    planned = {pedicle.name: pedicle for pedicle in stage.door.pedicles()}
    pedicles = [planned[name] for name in chosen(tuple(planned), wanted.pedicles)]
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

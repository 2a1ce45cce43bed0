"""A guard over a controller, held by this process as the service holds it: silence, and the guard's own death.

The service only forwards heartbeats; when a challenge was issued, from which silence counts, is known here exactly.
"""

import os
import signal
import time
from contextlib import ExitStack
from pathlib import Path
from types import TracebackType
from typing import Self

from benchmarks.stop.results import Trial
from benchmarks.stop.wire import first_stop_ms
from robot.guard.client import GuardConfig
from robot.guard.heartbeat import SILENCE_S
from robot.guard.messages import MotionEnded
from simulator.controller import ControllerProcess, ControllerSettings, free_loopback_address
from tests.robot.bench import Bench

_WAY_MM = 12.0  # a trial stops after a millimetre or two
_SPAN_MM = 30.0  # the arm turns back before it has gone so far up


class GuardRoom:
    """One guard and one controller, used trial by trial."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder

    def __enter__(self) -> Self:
        with ExitStack() as opened:
            settings = ControllerSettings(free_loopback_address())
            self._controller = opened.enter_context(ControllerProcess(settings))
            self._bench = Bench(GuardConfig(self._controller.address, self._folder), self._controller)
            opened.callback(self._bench.close)
            self._bench.start()
            self._lowest_mm = self._height_mm()
            self._opened = opened.pop_all()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._opened.close()

    def heartbeat(self, _: int) -> Trial:
        """The link is lost: milliseconds beyond the 200 that silence may last."""
        newest = self._move()
        self._bench.silent = True
        self._bench.told(MotionEnded)
        self._bench.silent = False
        late_ms = first_stop_ms(self._controller, newest, self._bench.last_challenge_at_s + SILENCE_S)
        self._calm()
        return Trial(late_ms, late_ms is not None, "moving")

    def kill_guard(self, _: int) -> Trial:
        """SIGKILL of the guard: its parent's stop or the controller's watchdog, whichever is first."""
        newest = self._move()
        guard = self._bench.client.process_id
        assert guard is not None
        at_s = time.monotonic()
        os.kill(guard, signal.SIGKILL)
        self._bench.until(lambda: not self._controller.state().moving, 5.0)
        late_ms = first_stop_ms(self._controller, newest, at_s)
        self._bench.until(lambda: self._bench.client.process_id not in (guard, None), 20.0)
        self._calm()
        return Trial(late_ms, late_ms is not None, "moving")

    def _move(self) -> int:
        """An arm under way; the number of the newest record before it ran."""
        self._bench.events.clear()
        newest = self._controller.wire()[-1].number
        up = self._height_mm() < self._lowest_mm + _SPAN_MM
        self._bench.move(_WAY_MM if up else -_WAY_MM)
        return newest

    def _calm(self) -> None:
        self._bench.until(self._bench.sees_the_arm, 20.0)
        self._bench.client.acknowledge()
        self._bench.until(lambda: self._bench.status.phase == "idle", 5.0)

    def _height_mm(self) -> float:
        return float(self._controller.state().base_from_flange_nominal[2, 3])

"""A guard over a controller, held by this process as the service holds it: silence, and the guard's own death.

The service only forwards heartbeats; when a challenge was issued, from which silence counts, is known here exactly.
"""

import os
import signal
import time
from contextlib import ExitStack, nullcontext
from pathlib import Path
from types import TracebackType
from typing import Self
from unittest.mock import patch

from benchmarks.stop.load import Load
from benchmarks.stop.precedence import put_ahead
from benchmarks.stop.results import Trial
from benchmarks.stop.wire import Wire
from robot.guard.client import GuardConfig
from robot.guard.heartbeat import SILENCE_S
from robot.guard.messages import MotionEnded
from simulator.controller import ControllerProcess, ControllerSettings, free_loopback_address
from tests.robot.bench import Bench

_WAY_MM = 12.0  # a trial stops after a millimetre or two
_SPAN_MM = 30.0  # the arm turns back before it has gone so far up
_UNDER_WAY_MM_S = 5.0


class GuardRoom:
    """One guard and one controller, used trial by trial."""

    def __init__(self, folder: Path, load: Load) -> None:
        self._folder = folder
        self._load = load

    def __enter__(self) -> Self:
        with ExitStack() as opened:
            settings = ControllerSettings(free_loopback_address())
            self._controller = opened.enter_context(ControllerProcess(settings))
            put_ahead(self._controller.pid)
            self._wire = Wire(self._controller)
            config = GuardConfig(self._controller.address, self._folder, restart_after_s=0.0)
            self._bench = Bench(config, self._controller)
            opened.callback(self._bench.close)
            with self._load.paused():
                self._bench.start()
            self._lowest_mm = self._height_mm()
            self._opened = opened.pop_all()
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._opened.close()

    def heartbeat(self, _: int) -> Trial:
        """The link is lost: milliseconds beyond the 200 that silence may last."""
        self._move()
        self._bench.silent = True
        ended = self._bench.told(MotionEnded)
        self._bench.silent = False
        late_ms = self._wire.first_stop_ms(self._bench.last_challenge_at_s + SILENCE_S)
        self._calm()
        return Trial(late_ms, late_ms is not None and late_ms >= 0.0, ended.cause)

    def kill_guard(self, number: int) -> Trial:
        """SIGKILL of the guard: its parent's stop, or, where that is withheld, the controller's watchdog alone."""
        alone = number % 2 == 1
        self._move()
        guard = self._bench.client.process_id
        assert guard is not None
        with patch("robot.guard.client.stop_by_dashboard") if alone else nullcontext():
            at_s = time.monotonic()
            os.kill(guard, signal.SIGKILL)
            late_ms = self._wire.first_stop_ms(at_s)
            self._bench.until(lambda: not self._controller.state().moving, 5.0)
        with self._load.paused():
            self._bench.until(lambda: self._bench.client.process_id not in (guard, None), 20.0)
            self._calm()
        return Trial(late_ms, late_ms is not None, "watchdog alone" if alone else "its parent lives")

    def _move(self) -> None:
        """An arm under way."""
        self._bench.events.clear()
        self._wire.mark()
        up = self._height_mm() < self._lowest_mm + _SPAN_MM
        self._bench.move(_WAY_MM if up else -_WAY_MM, _UNDER_WAY_MM_S)

    def _calm(self) -> None:
        self._bench.until(self._bench.sees_the_arm, 20.0)
        self._bench.client.acknowledge()
        self._bench.until(lambda: self._bench.status.phase == "idle", 5.0)

    def _height_mm(self) -> float:
        return float(self._controller.state().base_from_flange_nominal[2, 3])

"""A surgeon's hand on a guard over a simulated controller, each a process of its own."""

import threading
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace
from itertools import count
from typing import TypeVar

import numpy as np
import pytest

from robot.guard.client import GuardClient, GuardConfig
from robot.guard.messages import BeginMove, Event, Heartbeat, MotionEnded, MoveRefused, Status
from robot.refusal import RefusalCode
from simulator.controller import ControllerProcess, RuntimeState
from tests.waiting import until

Told = TypeVar("Told")


class Bench:
    """Holds, orders, and hears what the guard says."""

    def __init__(self, config: GuardConfig, controller: ControllerProcess | None = None) -> None:
        self._controller = controller
        self.journal_folder = config.journal_folder
        self.events: list[Event] = []
        self.held = True
        self.silent = False
        self.delay_s = 0.0
        self.permit_id = ""
        self.last_challenge_at_s = 0.0
        self._seen: deque[Status] = deque(maxlen=200)
        self._beating: threading.Thread | None = None
        self._over = threading.Event()
        self._permits = count(1)
        self.client = GuardClient(config, self._hear)

    def start(self) -> None:
        self.client.start()
        self.until(self.sees_the_arm, 15.0)
        self.client.acknowledge()
        self.until(lambda: self.status.phase == "idle", 2.0)

    def sees_the_arm(self) -> bool:
        """Whether a guard runs that has sound feedback."""
        status = self.client.status
        return status is not None and status.connected and time.monotonic() - status.sent_at_s < 0.2

    def close(self) -> None:
        self._let_be()
        self.client.close()

    @property
    def controller(self) -> ControllerProcess:
        assert self._controller is not None
        return self._controller

    @property
    def status(self) -> Status:
        status = self.client.status
        assert status is not None
        return status

    def hold(self, permit_id: str) -> None:
        """Send a heartbeat each 50 ms from now on, as the tablet does."""
        self._let_be()
        self._beating = threading.Thread(target=self._beat, args=(permit_id,))
        self._beating.start()
        self.until(lambda: self.status.permit_id == permit_id and self.status.heartbeat_age_s is not None, 2.0)

    def order(self, permit_id: str = "permit-1", step_mm: float = 40.0, **changes: object) -> BeginMove:
        """A motion upwards from where the arm is, as the controller is set up."""
        arm = self.status.arm
        assert arm is not None
        goal = arm.base_from_tcp.copy()
        goal[2, 3] += step_mm
        move = BeginMove(
            permit_id, goal, arm.joints_rad, 20.0, 50.0, abs(step_mm) / 20.0 + 0.4, np.eye(4), 1.0,
            np.array([0.0, 0.0, 50.0]), 0.05, 3e-4, 0.05, 5.0,
        )  # fmt: skip
        return replace(move, **changes)

    def move(self, step_mm: float = 40.0, under_way_mm_s: float = 15.0) -> None:
        """Hold, start a motion, and wait until the arm runs; under `permit_id`."""
        for _ in range(5):
            self.permit_id = f"permit-{next(self._permits)}"
            self.hold(self.permit_id)
            self.client.begin_move(self.order(self.permit_id, step_mm))
            self.until(lambda: self._is_faster_than(under_way_mm_s) or self._hold_lost(), 5.0)
            if not self._hold_lost():
                return
            # A crowded machine may lose the hold at once: the hand lets go, and tries again as a surgeon would.
            self.client.acknowledge()
            self.until(lambda: self.status.phase == "idle", 2.0)
            self.events.clear()
        pytest.fail("the machine is too busy to hold a motion")

    def _hold_lost(self) -> bool:
        refused = (event.refusal.code for event in self.events if isinstance(event, MoveRefused))
        return self.count(MotionEnded) > 0 or RefusalCode.NO_LIVE_HEARTBEAT in refused

    def _is_faster_than(self, speed_mm_s: float) -> bool:
        return self.controller.state().tcp_speed_mm_s > speed_mm_s

    def told(self, kind: type[Told], within_s: float = 10.0) -> Told:
        """The newest event of a kind, awaited."""
        self.until(lambda: any(isinstance(event, kind) for event in self.events), within_s)
        return next(event for event in reversed(self.events) if isinstance(event, kind))

    def count(self, kind: type[Event]) -> int:
        return sum(isinstance(event, kind) for event in self.events)

    def until(self, condition: Callable[[], bool], within_s: float) -> None:
        until(condition, within_s, lambda: [getattr(event, "cause", event) for event in self.events])

    def first_stop_after(self, at_s: float) -> float:
        """Seconds until the first stop reached the controller, by dashboard or register."""
        stops = [
            record.at_s - at_s
            for record in self.controller.wire()
            if record.at_s >= at_s and (record.text == "stop" or record.command == 255)
        ]
        return min(stops)

    def stays_at_rest(self, for_s: float = 0.6) -> None:
        """Nothing runs on the controller, and the arm stays where it is.

        A stop is told as stopping until the controller's next cycle, though nothing runs: whoever mourns a guard sends
        one, on a crowded machine as late as this looks.
        """
        self.until(lambda: not self.controller.state().moving, 3.0)
        before = self.controller.state()
        time.sleep(for_s)
        after = self.controller.state()
        assert after.program == ""
        assert np.array_equal(before.joints_rad, after.joints_rad)
        self.until(self._is_stopped, 1.0)

    def _is_stopped(self) -> bool:
        """Stopped for good: a paused program could go on."""
        return self.controller.state().runtime_state is RuntimeState.STOPPED

    def _let_be(self) -> None:
        if self._beating is not None:
            self._over.set()
            self._beating.join()
            self._over.clear()

    def _hear(self, event: Event) -> None:
        if isinstance(event, Status):
            self._seen.append(event)
        else:
            self.events.append(event)

    def _beat(self, permit_id: str) -> None:
        for number in count(1):
            now_s = time.monotonic()
            known = [status for status in list(self._seen) if status.sent_at_s <= now_s - self.delay_s]
            if known and not self.silent:
                self.last_challenge_at_s = known[-1].sent_at_s
                self.client.heartbeat(Heartbeat(permit_id, number, known[-1].challenge, self.held))
            if self._over.wait(0.05):
                return

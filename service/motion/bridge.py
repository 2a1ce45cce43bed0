"""The service's one way to the arm: the guard's client, what it says, and whether it may be unlocked."""

import threading
import time
from collections.abc import Callable

import structlog

from robot.errors import GuardDownError
from robot.guard.client import GuardClient, GuardConfig
from robot.guard.messages import BeginMove, Event, Fault, FaultKind, Heartbeat, PendantReleased, Phase, Status, StopSent
from service.motion.arm_watch import ArmWatch
from service.operations.counts import count_stop

# The guard tells of a stop within milliseconds; one that it has not told of by now was lost with it, or had no guard.
_TOLD_WITHIN_S = 5.0
OnEvent = Callable[[Event], None]
_log = structlog.get_logger(__name__)


class ArmBridge:
    """The guard of the room, or the lack of one; every method returns at once and may be called from any thread."""

    def __init__(self, config: GuardConfig | None) -> None:
        self.watch = ArmWatch()
        self._on_event: OnEvent = _ignore
        self._on_status: Callable[[], None] = _ignore
        self._client = None if config is None else GuardClient(config, self._take)
        self._stops_to_record = 0
        self._recorded = threading.Condition()
        self._pendant_released = threading.Event()
        self._stop_asked_s: float | None = None  # the oldest that the guard has not yet told to be out

    @property
    def status(self) -> Status | None:
        """The guard's newest status, however old."""
        return None if self._client is None else self._client.status

    @property
    def guard_age_s(self) -> float | None:
        """Age of the newest status; None without a guard or before its first."""
        return None if self._client is None else self._client.status_age_s

    def start(self, on_event: OnEvent, on_status: Callable[[], None]) -> None:
        """Spawn the guard, if there is an arm; in its thread, a status calls `on_status`, all else `on_event`."""
        self._on_event = on_event
        self._on_status = on_status
        if self._client is not None:
            self._client.start()

    def close(self) -> None:
        """End the guard, which stops the arm."""
        if self._client is not None:
            self._client.close()

    def stop(self, reason: str) -> bool:
        """Stop the arm, by guard and dashboard; the guard is locked from then on. True if the guard's pipe took it."""
        asked_s, now_s = self._stop_asked_s, time.monotonic()
        if asked_s is None or now_s - asked_s > _TOLD_WITHIN_S:
            self._stop_asked_s = now_s
        return self._client is not None and self._client.stop(reason)

    def release_pendant(self, reason: str) -> bool:
        """Stop the arm as `stop` does and leave it to the pendant. True if the guard's pipe took it."""
        self._pendant_released.clear()
        return self._client is not None and self._client.release_pendant(reason)

    def wait_for_pendant(self, timeout_s: float) -> bool:
        """Whether the guard says, within `timeout_s`, that the pendant has the arm and no program runs."""
        return self._pendant_released.wait(timeout_s)

    def stop_to_record(self) -> None:
        """A stop was sent that the record does not have yet: until it has, nothing unlocks the guard."""
        with self._recorded:
            self._stops_to_record += 1

    def stop_recorded(self) -> None:
        """The record has it."""
        with self._recorded:
            self._stops_to_record -= 1
            self._recorded.notify_all()

    def wait_for_record(self, timeout_s: float) -> None:
        """Wait until the record has every stop that was sent, at most `timeout_s`."""
        with self._recorded:
            self._recorded.wait_for(lambda: self._stops_to_record == 0, timeout_s)

    def unlock(self) -> bool:
        """A person has acknowledged: the guard may take motions again. It starts none.

        False where the guard did not take it, which is told as a fault. A stop that is still to be recorded keeps the
        guard locked, and a room without an arm has nothing to unlock: neither is a fault.
        """
        with self._recorded:
            if self._client is None or self._stops_to_record > 0 or self._client.acknowledge():
                return True
        return self._lost("the guard did not take an acknowledgement")

    def begin_move(self, move: BeginMove) -> bool:
        """Hand the guard a motion; False if there is no guard to take it, which is told as a fault."""
        try:
            if self._client is not None:
                self._client.begin_move(move)
                return True
        except GuardDownError as error:
            _log.error("motion_not_handed_over", code=error.code)
        return self._lost("no guard took a motion")

    def heartbeat(self, heartbeat: Heartbeat) -> None:
        """Forward a heartbeat; without a guard it is silence."""
        if self._client is not None:
            self._client.heartbeat(heartbeat)

    def is_moving(self) -> bool:
        """Whether the guard is in, or on its way into, a motion."""
        status = self.status
        return status is not None and status.phase in (Phase.STARTING, Phase.MOVING, Phase.STOPPING)

    def _lost(self, message: str) -> bool:
        """Tell a fault that the guard's client has not seen, on the way of all its faults; False, for the caller."""
        self._take(Fault(FaultKind.GUARD_LOST, time.monotonic(), message))
        return False

    def _take(self, event: Event) -> None:
        self.watch.take(event)
        if isinstance(event, Status):
            self._on_status()
            return
        if isinstance(event, StopSent):
            self._time_stop(event)
        if isinstance(event, PendantReleased) and event.program_running is False:
            self._pendant_released.set()
        self._on_event(event)

    def _time_stop(self, event: StopSent) -> None:
        asked_s, self._stop_asked_s = self._stop_asked_s, None
        if event.written and asked_s is not None and event.at_s >= asked_s:
            count_stop(event.at_s - asked_s)


def _ignore(*_: Event) -> None:
    """Nobody listens yet."""

"""The service's end of the guard: spawns the process, speaks to it, notices its death."""

import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from threading import Event as Signal
from threading import Thread

import structlog

from robot.dashboard import stop_by_dashboard
from robot.errors import GuardDownError, MessageError
from robot.guard.child import GuardChild
from robot.guard.lines import decode_event, encode
from robot.guard.messages import (
    Acknowledge,
    BeginMove,
    Command,
    Event,
    Fault,
    FaultKind,
    Heartbeat,
    Phase,
    ReleasePendant,
    Status,
    Stop,
)
from robot.guard.precedence import take_precedence

_LOOK_S = 0.05
_CLOSE_S = 6.0
_log = structlog.get_logger()


@dataclass(frozen=True, slots=True)
class GuardConfig:
    """How to run a guard."""

    arm_address: str
    journal_folder: Path
    silent_after_s: float = 1.0  # without a status the guard is killed and started again
    # While it starts, takes control or looks for a controller, the arm's library may block it for seconds.
    busy_silent_after_s: float = 8.0
    restart_after_s: float = 0.3


class GuardClient:
    """A supervised guard process; every method may be called from any thread, all but `close` return at once.

    Parameters
    ----------
    config : GuardConfig
    on_event : callable
        Called in the reading thread with every event; from asyncio:
        ``lambda event: loop.call_soon_threadsafe(queue.put_nowait, event)``.
        After the death of a guard it gets a `Fault` of kind guard_lost, then the events of the next one, which
        starts held.
    """

    def __init__(self, config: GuardConfig, on_event: Callable[[Event], None]) -> None:
        self._config = config
        self._on_event = on_event
        self._child: GuardChild | None = None
        self._closing = Signal()
        self._thread = Thread(target=self._supervise, name="guard", daemon=True)
        self._status: Status | None = None
        self._heard_at_s = 0.0
        self._busy = True

    def start(self) -> None:
        """Spawn the guard and the thread that watches it."""
        self._thread.start()

    @property
    def status(self) -> Status | None:
        """Newest status of the guard that runs, however old; None before its first."""
        return self._status

    @property
    def status_age_s(self) -> float | None:
        """Seconds since the newest status was sent."""
        status = self._status
        return None if status is None else time.monotonic() - status.sent_at_s

    @property
    def process_id(self) -> int | None:
        """Of the guard that runs now."""
        child = self._child
        return None if child is None else child.pid

    def begin_move(self, move: BeginMove) -> None:
        """Ask for a motion; the answer is MotionStarted or MoveRefused. GuardDownError if there is no guard."""
        if not self._send(move):
            raise GuardDownError("no guard takes commands")

    def heartbeat(self, heartbeat: Heartbeat) -> None:
        """Forward a heartbeat; dropped silently if there is no guard, which then is silence."""
        self._send(heartbeat)

    def stop(self, reason: str) -> bool:
        """Stop the arm: through the guard, and by a dashboard connection of this process in parallel.

        Never raises; True if the guard's pipe took it. The parallel stop runs in a thread of its own.
        """
        return self._stop(Stop(reason))

    def release_pendant(self, reason: str) -> bool:
        """Stop as `stop` does, and leave the arm to a person at the pendant; `PendantReleased` follows."""
        return self._stop(ReleasePendant(reason))

    def _stop(self, command: Stop | ReleasePendant) -> bool:
        taken = self._send(command)
        beside = Thread(target=stop_by_dashboard, args=(self._config.arm_address,), name="stop", daemon=True)
        try:
            beside.start()
        except RuntimeError:  # no thread is left on this machine: then whoever stops waits for it
            stop_by_dashboard(self._config.arm_address)
        return taken

    def acknowledge(self) -> bool:
        """A human has acknowledged (on opening a case and on leaving safe_hold); True if the guard's pipe took it."""
        return self._send(Acknowledge())

    def close(self) -> None:
        """End the guard: its pipe is closed, it stops the arm and exits; killed if it does not."""
        self._closing.set()
        child = self._child
        if child is not None:
            child.dismiss()
        if self._thread.is_alive():
            self._thread.join(_CLOSE_S)

    def _send(self, command: Command) -> bool:
        child = self._child
        return child is not None and child.send(encode(command))

    def _supervise(self) -> None:
        take_precedence(passed_on=False)  # it dies first if this process is killed, and the guard with it
        while not self._closing.is_set():
            child = self._spawn()
            if child is None:
                continue
            self._child, self._busy, self._heard_at_s = child, True, time.monotonic()
            if self._closing.is_set():
                child.dismiss()
            self._listen(child)
            self._child = None
            child.end(at_once=not self._closing.is_set())
            if not self._closing.is_set():
                self._mourn()

    def _spawn(self) -> GuardChild | None:
        """A guard process; None, a moment later, from a machine that has no process left to give."""
        try:
            return GuardChild(self._config.arm_address, self._config.journal_folder)
        except OSError as error:
            _log.error("guard_not_started", error=repr(error))
            self._closing.wait(self._config.restart_after_s)
            return None

    def _listen(self, child: GuardChild) -> None:
        """Pass events on until the guard ends, falls silent, or says what is no message."""
        while (lines := child.read(_LOOK_S)) is not None:
            try:
                for line in lines:
                    self._take(decode_event(line))
            except MessageError:
                return
            limit_s = self._config.busy_silent_after_s if self._busy else self._config.silent_after_s
            if time.monotonic() - self._heard_at_s > limit_s:
                return

    def _take(self, event: Event) -> None:
        if isinstance(event, Status):
            self._status = event
            self._heard_at_s = time.monotonic()
            self._busy = event.phase is Phase.STARTING or not event.connected
        self._pass_on(event)

    def _mourn(self) -> None:
        """The guard is gone: stop the arm from here, without waiting for the controller's watchdog (H17)."""
        self._status = None
        stop_by_dashboard(self._config.arm_address)
        self._pass_on(Fault(FaultKind.GUARD_LOST, time.monotonic(), "the guard died or fell silent"))
        self._closing.wait(self._config.restart_after_s)

    def _pass_on(self, event: Event) -> None:
        try:
            self._on_event(event)
        except Exception as error:  # noqa: BLE001  # a listener's fault must not end the supervision of the arm
            _log.error("guard_listener_failed", event_type=type(event).__name__, error=repr(error))

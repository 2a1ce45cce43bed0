"""The service's end of the guard: spawns the process, speaks to it, notices its death."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from robot.guard.messages import BeginMove, Event, Heartbeat, Status


@dataclass(frozen=True, slots=True)
class GuardConfig:
    """How to run a guard."""

    arm_address: str
    journal_folder: Path
    silent_after_s: float = 1.0  # without a status the guard is killed and started again
    start_within_s: float = 10.0


class GuardClient:
    """A supervised guard process; every method may be called from any thread and returns at once.

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
        raise NotImplementedError

    def start(self) -> None:
        """Spawn the guard and the thread that watches it."""
        raise NotImplementedError

    @property
    def status(self) -> Status | None:
        """Newest status, however old; None before the first."""
        raise NotImplementedError

    @property
    def status_age_s(self) -> float | None:
        """Seconds since the newest status arrived."""
        raise NotImplementedError

    def begin_move(self, move: BeginMove) -> None:
        """Ask for a motion; the answer is MotionStarted or MoveRefused. GuardDownError if there is no guard."""
        raise NotImplementedError

    def heartbeat(self, heartbeat: Heartbeat) -> None:
        """Forward a heartbeat; dropped silently if there is no guard, which then is silence."""
        raise NotImplementedError

    def stop(self, reason: str) -> bool:
        """Stop the arm: through the guard, and by a dashboard connection of this process in parallel.

        Never raises; True if the guard's pipe took it. The parallel stop runs in a thread of its own.
        """
        raise NotImplementedError

    def acknowledge(self) -> None:
        """A human has acknowledged (on opening a case and on leaving safe_hold)."""
        raise NotImplementedError

    def close(self) -> None:
        """End the guard: its pipe is closed, it stops the arm and exits; killed if it does not."""
        raise NotImplementedError

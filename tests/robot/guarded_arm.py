"""A guard over an arm of numbers, with a clock that is turned by hand."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from robot.arm import ArmState, LinearMove
from robot.guard.guard import Guard
from robot.guard.journal import Journal
from robot.guard.messages import Acknowledge, BeginMove, EndCause, Event, Heartbeat, MotionEnded, Status

TURN_S = 0.008


class Room:
    """An arm that does what it is told, a guard over it, and the time."""

    def __init__(self, reading: ArmState, journal: Journal) -> None:
        self.now_s = 100.0
        self.reading = reading
        self.orders: list[str] = []
        self.events: list[Event] = []
        self.journal = journal
        self.severed = False
        self.while_control_is_taken: Callable[[], None] = lambda: None
        self.guard = Guard(self, journal, self.events.append, lambda: self.now_s)
        self.turn()
        self.guard.handle(Acknowledge())

    def turn(self, seconds: float = TURN_S) -> None:
        """Let time pass and the guard have a look."""
        self.now_s += seconds
        self.guard.tick()

    def beat(self, number: int, challenge: str | None = None, held: bool = True) -> None:
        self.guard.handle(Heartbeat("permit-1", number, challenge or self.challenge(), held))

    def challenge(self) -> str:
        return next(event.challenge for event in reversed(self.events) if isinstance(event, Status))

    def newest(self, kind: type[Event]) -> Event | None:
        return next((event for event in reversed(self.events) if isinstance(event, kind)), None)

    # What follows is the Arm protocol.

    def read(self) -> ArmState:
        return replace(self.reading, controller_time_s=self.now_s, received_at_s=self.now_s)

    def connect(self) -> bool:
        return True

    def take_control(self, watchdog_hz: float) -> None:
        self.orders.append("control")
        self.reading = replace(self.reading, program_running=True)
        self.while_control_is_taken()

    def flange_from_tcp(self) -> np.ndarray:
        return np.eye(4)

    def move_linear(self, move: LinearMove) -> None:
        self.orders.append("move")

    def feed_watchdog(self) -> None:
        self.orders.append("feed")

    def send_stop(self) -> bool:
        self.orders.append("stop")
        self.reading = replace(self.reading, program_running=False)
        return True

    def stop_script(self) -> None:
        self.orders.append("stop script")

    def give_up_control(self) -> None:
        self.orders.append("give up")

    def release_pendant(self) -> None:
        self.orders.append("release")

    def is_severed(self) -> bool:
        return self.severed

    def is_stuck(self) -> bool:
        return False

    def close(self) -> None:
        pass


def begin(room: Room, move: BeginMove) -> None:
    """Ask for a motion while the button is held."""
    room.turn(0.03)
    room.beat(1)
    room.guard.handle(move)
    room.turn()


def ended(room: Room, within_s: float = 2.0, *, held: bool = True) -> EndCause:
    """Turn until the motion is over, the button held on or not: why it ended."""
    end_s, number = room.now_s + within_s, 1
    while room.newest(MotionEnded) is None:
        assert room.now_s < end_s, "the motion goes on"
        number += 1
        if held:
            room.beat(number)
        room.turn()
    return room.newest(MotionEnded).cause

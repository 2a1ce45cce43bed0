"""However many commands arrive, the guard looks at the arm between them."""

import pytest

from robot.guard import process
from robot.guard.messages import Heartbeat
from tests.robot.guarded_arm import Room


class Flood:
    """An inbox that never empties."""

    def __init__(self) -> None:
        self.taken = 0

    def get(self, timeout: float) -> Heartbeat:
        self.taken += 1
        assert self.taken < 1000, "nothing else comes to its turn"
        return Heartbeat("permit-1", self.taken, "unknown", held=True)


@pytest.mark.hazard("H32")
def test_commands_without_end_keep_the_guard_from_nothing(room: Room) -> None:
    assert process._handle(room.guard, Flood()) is False

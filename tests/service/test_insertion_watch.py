"""The watch over an insertion (H29): it looks ten times a second and more, and alarms at its limits, once."""

import asyncio
import math
from types import SimpleNamespace

import pytest

from service.motion.displacement import Displacement
from service.motion.insertion_watch import watch_insertions
from workflow.limits import Limits
from workflow.states import State

LIMITS = Limits()


class Watched:
    """An insertion under way, its drift, and what was recorded of it."""

    def __init__(self, drift: Displacement | None, state: State = State.INSERTING) -> None:
        self.live = SimpleNamespace(state=state, case_id="case", insertion=SimpleNamespace(id="insertion"))
        self.rules = SimpleNamespace(limits=LIMITS)
        self.bridge = SimpleNamespace(watch=self)
        self.looks, self.alarms, self._drift = 0, 0, drift

    def drift(self) -> Displacement | None:
        self.looks += 1
        return self._drift

    def observe(self, *_: object) -> None:
        self.alarms += 1

    def for_s(self, seconds: float) -> "Watched":
        async def watch() -> None:
            watching = asyncio.create_task(watch_insertions(self))
            await asyncio.sleep(seconds)
            watching.cancel()

        asyncio.run(watch())
        return self


@pytest.mark.real_time
def test_it_looks_at_least_ten_times_a_second():
    watched = Watched(Displacement(LIMITS.drift_mm, LIMITS.drift_rad)).for_s(1.0)
    assert watched.looks >= 10
    assert watched.alarms == 0


@pytest.mark.hazard("H29")
@pytest.mark.parametrize("drift", [Displacement(0.3001, 0.0), Displacement(0.0, math.radians(0.1001))])
@pytest.mark.parametrize("state", [State.INSERTING, State.SLEEVE_INSERTED])
def test_drift_beyond_a_limit_alarms_once(drift, state):
    assert Watched(drift, state).for_s(0.3).alarms == 1


def test_without_an_insertion_it_is_still():
    assert Watched(Displacement(5.0, 1.0), State.VERIFIED).for_s(0.2).alarms == 0

"""The watch over an insertion (H29): it looks ten times a second and more, and alarms at its limits, once."""

import asyncio
import math
import threading
from types import SimpleNamespace

import pytest

from service.motion.displacement import Displacement
from service.motion.insertion_watch import watch_insertions
from workflow.limits import Limits
from workflow.states import State
from workflow.triggers import Trigger

LIMITS = Limits()


class Watched:
    """An insertion under way, its drift, and what was recorded of it."""

    def __init__(
        self, drift: Displacement | None, state: State = State.INSERTING, verified: bool = True, program: bool = False
    ) -> None:
        insertion = SimpleNamespace(id="insertion")
        verification = SimpleNamespace() if verified else None
        self.live = SimpleNamespace(state=state, case_id="case", insertion=insertion, verification=verification)
        self.rules = SimpleNamespace(limits=LIMITS)
        self.bridge = SimpleNamespace(watch=self, stop=self.stop)
        self.looks, self.stops, self.told, self._drift, self._program = 0, 0, [], drift, program

    @property
    def alarms(self) -> int:
        return self.told.count(Trigger.ARM_DISTURBED)

    def drift(self) -> Displacement | None:
        self.looks += 1
        return self._drift

    def reading(self) -> SimpleNamespace:
        return SimpleNamespace(arm=SimpleNamespace(program_running=self._program))

    def stop(self, _reason: str) -> None:
        self.stops += 1

    def observe(self, _case_id: str, trigger: Trigger, _prepare: object) -> None:
        assert trigger is not Trigger.FAULT or self.stops  # which goes out first
        self.told.append(trigger)
        if trigger is Trigger.FAULT:
            self.live.state = State.SAFE_HOLD

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
@pytest.mark.parametrize("state", [State.INSERTING, State.SLEEVE_INSERTED, State.SAFE_HOLD])
def test_drift_beyond_a_limit_alarms_once(drift, state):
    assert Watched(drift, state).for_s(0.3).alarms == 1


@pytest.mark.hazard("H29")
def test_program_that_starts_on_the_controller_is_stopped_and_told_once():
    watched = Watched(None, program=True).for_s(0.3)
    assert (watched.stops, watched.told) == (1, [Trigger.FAULT])


@pytest.mark.parametrize(("state", "verified"), [(State.VERIFIED, True), (State.SAFE_HOLD, False)])
def test_where_no_verified_guide_takes_a_sleeve_it_is_still(state, verified):
    watched = Watched(Displacement(5.0, 1.0), state, verified, program=True).for_s(0.2)
    assert (watched.stops, watched.told) == (0, [])


@pytest.mark.hazard("H29")
def test_a_look_that_fails_does_not_end_the_watch(monkeypatch):
    watched, observe, alarmed = Watched(Displacement(5.0, 1.0)), Watched.observe, threading.Event()
    outcomes = iter([lambda: 1 / 0, alarmed.set])

    def fail_once(self: Watched, *recorded: object) -> None:
        next(outcomes)()
        observe(self, *recorded)

    async def watch() -> bool:
        watching = asyncio.create_task(watch_insertions(watched))
        told = await asyncio.to_thread(alarmed.wait, 20.0)
        watching.cancel()
        return told

    monkeypatch.setattr(Watched, "observe", fail_once)
    assert asyncio.run(watch())

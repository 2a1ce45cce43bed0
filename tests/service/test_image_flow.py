"""Images on their way into a case: one that meets a defect shuts out none of those behind it (H31)."""

import asyncio
from types import SimpleNamespace
from typing import Any

import pytest

from service.conductor.image_flow import ImageFlow
from service.conductor.taking import Prepared
from service.errors import ErrorCode, ServiceError
from workflow.decisions import Effect
from workflow.facts import RegistrationRefused
from workflow.triggers import Trigger


def _conductor() -> Any:
    return SimpleNamespace(on_effect={})


async def _until(work: Any, enough: asyncio.Event) -> None:
    task = asyncio.create_task(work)
    await asyncio.wait_for(enough.wait(), 5.0)
    assert not task.done()
    task.cancel()


@pytest.mark.hazard("H31")
def test_an_image_that_breaks_its_taking_in_shuts_out_none_behind_it(monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[str] = []

    async def run() -> None:
        enough, loop = asyncio.Event(), asyncio.get_running_loop()

        def take_in(_conductor: Any, image_id: str) -> None:
            if image_id == "broken":
                raise ZeroDivisionError("a defect")
            taken.append(image_id)
            loop.call_soon_threadsafe(enough.set)

        monkeypatch.setattr("service.conductor.image_flow.take_in", take_in)
        monkeypatch.setattr(ImageFlow, "_left_over", lambda _flow: [])
        flow = ImageFlow(_conductor())
        flow.stored("broken")
        flow.stored("good")
        await _until(flow.take_in_all(), enough)

    asyncio.run(run())
    assert taken == ["good"]


@pytest.mark.parametrize(("busy_tries", "taken_in"), [(2, ["first", "second"]), (99, ["second"])])
def test_an_image_that_meets_a_busy_database_is_tried_again_before_those_behind_it(
    monkeypatch: pytest.MonkeyPatch, busy_tries: int, taken_in: list[str]
) -> None:
    tried: list[str] = []
    taken: list[str] = []

    async def run() -> None:
        enough, loop = asyncio.Event(), asyncio.get_running_loop()

        def take_in(_conductor: Any, image_id: str) -> None:
            tried.append(image_id)
            if image_id == "first" and len(tried) <= busy_tries:
                raise ServiceError(ErrorCode.DATABASE_BUSY, "another writer held the database too long")
            taken.append(image_id)
            if image_id == "second":
                loop.call_soon_threadsafe(enough.set)

        monkeypatch.setattr("service.conductor.image_flow.take_in", take_in)
        monkeypatch.setattr("service.conductor.image_flow._BUSY_PAUSE_S", 0.0)
        monkeypatch.setattr(ImageFlow, "_left_over", lambda _flow: [])
        flow = ImageFlow(_conductor())
        flow.stored("first")
        flow.stored("second")
        await _until(flow.take_in_all(), enough)

    asyncio.run(run())
    assert taken == taken_in


def test_a_result_that_breaks_its_record_shuts_out_none_behind_it(monkeypatch: pytest.MonkeyPatch) -> None:
    async def run() -> None:
        enough = asyncio.Event()

        async def register(_flow: ImageFlow, _case_id: str, image_id: str) -> None:
            if image_id == "broken":
                raise KeyError("a defect")
            enough.set()

        monkeypatch.setattr(ImageFlow, "_register", register)
        conductor = _conductor()
        flow = ImageFlow(conductor)
        for image_id in ("broken", "good"):
            event, decision = SimpleNamespace(case_id="case"), SimpleNamespace(effects=())
            prepared = SimpleNamespace(made={"image": image_id})
            conductor.on_effect[Effect.REGISTRATION_STARTS](
                SimpleNamespace(event=event, decision=decision, prepared=prepared)
            )
        await _until(flow.work_through(), enough)

    asyncio.run(run())


def test_a_result_that_meets_a_busy_database_is_recorded_later(monkeypatch: pytest.MonkeyPatch) -> None:
    tries: list[str] = []

    def observe(case_id: str, _trigger: Trigger, _prepare: Any) -> None:
        tries.append(case_id)
        if len(tries) < 3:
            raise ServiceError(ErrorCode.DATABASE_BUSY, "another writer held the database too long")

    async def run() -> None:
        conductor = _conductor()
        conductor.observe = observe
        prepared = Prepared(RegistrationRefused("image", "mirrored"), data={"image_id": "image"})
        await ImageFlow(conductor)._observe("case", Trigger.REGISTRATION_REFUSED, prepared)

    monkeypatch.setattr("service.conductor.image_flow._BUSY_PAUSE_S", 0.0)
    asyncio.run(run())
    assert len(tries) == 3

"""The stream of events: every one once, in order, from any point on, whoever wrote it."""

import asyncio
import threading

import pytest

from service.auth.permissions import Role
from service.cases import store
from service.cases.feed import EventFeed
from service.cases.records import NewCase, NewEvent
from service.database.engines import open_database

_EVENT = NewEvent("noted", None, "case_open", {}, {}, changes_state=False)


@pytest.fixture
def case(database, users):
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    with database.write() as connection:
        store.open_case(connection, NewCase("case-1", "room-1", "P1", "1", surgeon.id, "0" * 64, {}, {}), _EVENT)


def _append(database, times: int) -> None:
    for _ in range(times):
        with database.write() as connection:
            store.append(connection, "case-1", _EVENT, expected_version=None)


async def _take(stream, count: int) -> list[int]:
    sequences = []
    async with asyncio.timeout(10):
        async for event in stream:
            sequences.append(event.sequence)
            if len(sequences) == count:
                break
    await stream.aclose()
    return sequences


def test_a_stream_tells_what_was_and_what_comes_without_gap_or_repeat(database, case):
    _append(database, 4)

    async def follow() -> list[int]:
        writer = threading.Thread(target=_append, args=(database, 50))
        writer.start()
        try:
            return await _take(EventFeed(database).follow("case-1"), 55)
        finally:
            writer.join()

    assert asyncio.run(follow()) == list(range(1, 56))


def test_a_stream_goes_on_behind_the_last_event_that_was_seen(database, case):
    _append(database, 9)
    assert asyncio.run(_take(EventFeed(database).follow("case-1", after=7), 3)) == [8, 9, 10]


def test_a_commit_wakes_the_stream_long_before_it_looks_by_itself(database, case, monkeypatch):
    monkeypatch.setattr("service.cases.feed._POLL_S", 60.0)

    async def follow() -> list[int]:
        stream = EventFeed(database).follow("case-1", after=1)
        taking = asyncio.create_task(_take(stream, 1))
        await asyncio.sleep(0.3)
        await asyncio.to_thread(_append, database, 1)
        return await taking

    assert asyncio.run(follow()) == [2]


def test_what_another_process_wrote_is_told_too(database, case):
    other = open_database(str(database.writer.url))

    async def follow() -> list[int]:
        taking = asyncio.create_task(_take(EventFeed(database).follow("case-1", after=1), 1))
        await asyncio.sleep(0.2)
        await asyncio.to_thread(_append, other, 1)
        return await taking

    try:
        assert asyncio.run(follow()) == [2]
    finally:
        other.close()


def test_a_stream_that_was_left_is_forgotten(database, case):
    feed = EventFeed(database)
    asyncio.run(_take(feed.follow("case-1"), 1))
    assert feed._sleepers == set()
    _append(database, 1)

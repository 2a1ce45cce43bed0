"""The stream of events: every one once, in order, from any point on, whoever wrote it, however many follow it."""

import asyncio
import threading
from contextlib import aclosing

import pytest

from service.auth.permissions import Role
from service.cases import channel, store
from service.cases.feed import EventFeed
from service.cases.records import NewCase, NewEvent
from service.database.engines import open_database
from service.errors import ErrorCode, ServiceError

_EVENT = NewEvent("noted", None, "case_open", {}, {}, changes_state=False)
_PATIENCE_S = 30.0


@pytest.fixture
def case(database, users):
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    with database.write() as connection:
        store.open_case(connection, NewCase("case-1", "room-1", "P1", "1", surgeon.id, "0" * 64, {}, {}), _EVENT)


def _append(database, times: int) -> None:
    for _ in range(times):
        with database.write() as connection:
            store.append(connection, "case-1", _EVENT, expected_version=None)


async def _take(feed: EventFeed, count: int, after: int = 0, pause_s: float = 0.0) -> list[int]:
    sequences: list[int] = []
    async with asyncio.timeout(_PATIENCE_S), aclosing(feed.follow("case-1", after)) as followed:
        async for events in followed:
            sequences += [event.sequence for event in events]
            if len(sequences) >= count:
                break
            await asyncio.sleep(pause_s)
    return sequences


async def _while_written(database, times: int, *taking) -> list[list[int]]:
    writer = threading.Thread(target=_append, args=(database, times))
    writer.start()
    try:
        return await asyncio.gather(*taking)
    finally:
        await asyncio.to_thread(writer.join)


def test_a_stream_tells_what_was_and_what_comes_without_gap_or_repeat(database, case):
    _append(database, 4)

    async def follow() -> list[list[int]]:
        return await _while_written(database, 50, _take(EventFeed(database), 55))

    assert asyncio.run(follow()) == [list(range(1, 56))]


def test_a_stream_goes_on_behind_the_last_event_that_was_seen(database, case):
    _append(database, 9)
    assert asyncio.run(_take(EventFeed(database), 3, after=7)) == [8, 9, 10]


def test_fast_and_slow_followers_are_told_the_same(database, case, monkeypatch):
    monkeypatch.setattr(channel, "_KEPT", 3)  # the slow one is soon behind what is at hand

    async def follow() -> list[list[int]]:
        feed = EventFeed(database)
        slow = [_take(feed, 81, pause_s=0.2) for _ in range(2)]
        return await _while_written(database, 80, *[_take(feed, 81) for _ in range(8)], *slow)

    assert asyncio.run(follow()) == [list(range(1, 82))] * 10


def test_an_event_is_read_once_for_all_who_follow(database, case, monkeypatch):
    monkeypatch.setattr(channel, "_POLL_S", 600.0)
    reads, looked, events_after = [], threading.Event(), store.events_after

    def counted(*given) -> list:
        reads.append(given)
        if len(reads) == 21:  # each looks once by itself, and the channel once
            looked.set()
        return events_after(*given)

    monkeypatch.setattr(store, "events_after", counted)

    async def follow() -> None:
        feed = EventFeed(database)
        taking = [asyncio.create_task(_take(feed, 1, after=1)) for _ in range(20)]
        assert await asyncio.to_thread(looked.wait, _PATIENCE_S)
        reads.clear()
        await asyncio.to_thread(_append, database, 1)
        assert await asyncio.gather(*taking) == [[2]] * 20

    asyncio.run(follow())
    assert 1 <= len(reads) <= 2  # after the commit, and perhaps already behind what it found


def test_a_commit_wakes_the_stream_long_before_it_looks_by_itself(database, case, monkeypatch):
    monkeypatch.setattr(channel, "_POLL_S", 600.0)

    async def follow() -> list[int]:
        taking = asyncio.create_task(_take(EventFeed(database), 1, after=1))
        await asyncio.sleep(0.3)
        await asyncio.to_thread(_append, database, 1)
        return await taking

    assert asyncio.run(follow()) == [2]


def test_what_another_process_wrote_is_told_too(database, case):
    other = open_database(str(database.writer.url))

    async def follow() -> list[int]:
        taking = asyncio.create_task(_take(EventFeed(database), 1, after=1))
        await asyncio.sleep(0.2)
        await asyncio.to_thread(_append, other, 1)
        return await taking

    try:
        assert asyncio.run(follow()) == [2]
    finally:
        other.close()


@pytest.mark.parametrize(
    "fault", [ServiceError(ErrorCode.DATABASE_BUSY, "another writer"), RuntimeError("a defect")], ids=repr
)
def test_a_stream_outlives_a_database_that_does_not_answer_for_a_while(database, case, monkeypatch, fault):
    monkeypatch.setattr(channel, "_POLL_S", 0.05)
    newest, failures = store.newest_sequence, [fault] * 3

    def failing(*given) -> int:
        if failures:
            raise failures.pop()
        return newest(*given)

    monkeypatch.setattr(store, "newest_sequence", failing)

    async def follow() -> list[list[int]]:
        return await _while_written(database, 5, _take(EventFeed(database), 6))

    assert asyncio.run(follow()) == [[1, 2, 3, 4, 5, 6]]


def test_silence_is_told(database, case):
    async def follow() -> list[int]:
        async with aclosing(EventFeed(database).follow("case-1", 1, quiet_s=0.05)) as followed:
            return [len(await anext(followed)) for _ in range(3)]

    assert asyncio.run(follow()) == [0, 0, 0]


def test_a_stream_that_was_left_is_forgotten(database, case):
    feed = EventFeed(database)
    asyncio.run(_take(feed, 1))
    assert feed._channels == {}
    _append(database, 1)

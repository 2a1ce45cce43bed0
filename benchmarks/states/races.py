"""One permit and many hands: 2 to 64 clients hold the button for the same permit at once; one motion starts.

Every client is a WebSocket of the service's own route. Most hold the control lease (one session at many tablets); some
speak for another surgeon. Each permit is contested once, and spent by whoever comes first.
"""

import asyncio
import json
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any
from uuid import uuid4

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import InvalidStatus

from benchmarks.states.room import PIN, TARGET, Room, scripted_room
from robot.guard.messages import EndCause
from service.cases import store
from service.cases.records import ArtefactKind
from tests.postgresql_server import postgresql_server

Trial = dict[str, Any]
FEWEST, MOST = 2, 64  # clients
_SIZES = ((FEWEST, 8), (9, 24), (25, MOST))
_CASE = {"patient_id": "P1", "study_uid": "1.2.3", "targets": [TARGET]}
_PATIENCE_S = 60.0
# What a hand may be told that comes after another, or without control.
_LATE = {"arm_moving", "interlock", "missing", "lease_lost", "lease_missing", "held"}


@dataclass
class Contest:
    """A case whose permits are contested, one after the other."""

    room: Room
    case_id: str
    control_token: int
    version: int

    def command(self, name: str, **body: object) -> dict[str, Any]:
        """A command of the surgeon in control; it must be taken."""
        headers = {"If_Match": f'"{self.version}"', "Idempotency_Key": uuid4().hex}
        headers |= {"Control_Token": str(self.control_token)} if self.control_token else {}
        answer = self.room.line.send(
            "POST", f"/cases/{self.case_id}/{name}", self.room.tokens["surgeon"], body, **headers
        )
        if answer.code is not None:
            raise RuntimeError(f"{name}: {answer.code}: {answer.body}")
        self.version = answer.body["version"]
        return dict(answer.body)

    def permit(self) -> str:
        """A plan, approved."""
        plan = self.command("plan-requested", kind="retreat", distance_mm=10.0)
        return str(self.command("move-approved", plan_id=plan["made"]["plan"], pin=PIN)["made"]["permit"])

    def look(self) -> str:
        """State and version as they are now."""
        answer = self.room.line.send("GET", f"/cases/{self.case_id}", self.room.tokens["surgeon"])
        self.version = answer.body["version"]
        return str(answer.body["state"])


def opened(room: Room) -> Contest:
    """A case with an empty guide and a surgeon in control."""
    room.upload_devices()
    answer = room.line.send("POST", "/cases", room.tokens["surgeon"], _CASE, Idempotency_Key=uuid4().hex)
    contest = Contest(room, str(answer.body["id"]), 0, 1)
    contest.command("guide-state-stated", guide="empty")
    contest.control_token = int(contest.command("lease-taken", reason="start")["detail"]["control_token"])
    return contest


def contested(contest: Contest, number: int) -> Trial:
    """One permit, contested by as many hands as the number says; bad unless exactly one motion came of it."""
    random = Random(number)
    hands = random.randint(FEWEST, MOST)
    permit, moves_before = contest.permit(), len(contest.room.guard.moves)
    strangers = random.sample(range(hands), random.randint(0, hands // 4))
    told = asyncio.run(_all_at_once(contest, permit, hands, set(strangers)))
    handed_over = [move.permit_id for move in contest.room.guard.moves[moves_before:]]
    recorded = _recorded(contest, permit)
    state = contest.look()
    sound = handed_over == [permit] and recorded == (1, 1) and state == "case_open"
    known = set(told) <= _LATE | {"released"} and told["released"] == 1
    return {
        "number": number,
        "kind": next(f"{low} to {high} clients" for low, high in _SIZES if hands <= high),
        "bad": not (sound and known),
        "clients": hands,
        "told": dict(told),
        "handed_over": len(handed_over),
        "recorded": recorded,
    }


async def _all_at_once(contest: Contest, permit: str, hands: int, strangers: set[int]) -> Counter[str]:
    """What each hand was told; the button is let go when only one still holds it."""
    ready = asyncio.Barrier(hands)
    holds = {asyncio.create_task(_hold(contest, permit, ready, hand in strangers)) for hand in range(hands)}
    pending, end_s = holds, time.monotonic() + _PATIENCE_S
    while len(pending) > 1 and time.monotonic() < end_s:
        _, pending = await asyncio.wait(pending, timeout=1.0, return_when=asyncio.FIRST_COMPLETED)
    if await asyncio.to_thread(contest.room.guard.begun.acquire, timeout=_PATIENCE_S):
        contest.room.guard.end(EndCause.RELEASED, at_goal=False)
    await asyncio.wait(pending, timeout=_PATIENCE_S)
    return Counter(hold.result() if hold.done() else "never answered" for hold in holds)


async def _hold(contest: Contest, permit: str, ready: asyncio.Barrier, stranger: bool) -> str:
    """Hold the button at the same moment as all others; how it ended."""
    room = contest.room
    token = room.tokens["second" if stranger else "surgeon"]
    url = f"ws://127.0.0.1:{room.port}/api/cases/{contest.case_id}/hold"
    url += f"?permit={permit}&control_token={contest.control_token}"
    await ready.wait()
    try:
        async with connect(url, additional_headers={"Authorization": f"Bearer {token}"}, proxy=None) as socket:
            await socket.send(json.dumps({"number": 1, "challenge": "c1", "held": True}))
            return await _told(socket)
    except InvalidStatus as refused:
        return str(json.loads(refused.response.body)["code"])


async def _told(socket: ClientConnection) -> str:
    async for text in socket:
        message = json.loads(text)
        if message["type"] == "ended":
            return str(message["problem"]["code"] if message["cause"] == "refused" else message["cause"])
    return "hung up"


def _recorded(contest: Contest, permit: str) -> tuple[int, int]:
    """How often the record has the permit used, and a motion started by it."""
    with contest.room.parts.database.read() as connection:
        uses = store.artefacts_of(connection, ArtefactKind.PERMIT_USE, contest.case_id)
        starts = store.events_of_kind(connection, contest.case_id, ["move_started"])
    used = [use for use in uses if use.id == permit]
    return len(used), sum(event.data["made"]["motion"] == use.content["motion_id"] for event in starts for use in used)


def on_sqlite(_folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Contested permits by number, in one case of one service."""
    with TemporaryDirectory() as place:
        yield from races(Path(place), numbers)


def on_postgresql(_folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """The same on a server of its own."""
    with TemporaryDirectory() as place, postgresql_server() as server:
        yield from races(Path(place), numbers, server)


def races(folder: Path, numbers: Iterable[int], address: str | None = None) -> Iterator[Trial]:
    """Contested permits by number, in one case of a service on an empty database."""
    with scripted_room(folder, address) as room:
        contest = opened(room)
        for number in numbers:
            yield contested(contest, number)

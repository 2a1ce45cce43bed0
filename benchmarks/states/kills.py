"""SIGKILL of the running service at random moments: what was acknowledged is there, once, and nothing moves.

`coaxial serve` as a process, over a simulated controller; one case goes on from kill to kill. Motions are of a
millimetre, and the C-arm sends one rendered image again and again, each time with pixels of its own. The first service
of a part and every twentieth behind it is started whole; the others are forked from a process that has imported
everything, since the imports took most of a trial's time.
"""

import threading
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, suppress
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from random import Random
from tempfile import TemporaryDirectory
from typing import Any
from uuid import uuid4

import numpy as np

from benchmarks.evidence.power_loss import look
from benchmarks.evidence.served_room import serve_room
from benchmarks.stop.forked_service import ForkedService, Nursery
from coaxial_client import Case, NoAnswer, Refused
from service.cases import store
from service.cases.records import StoredEvent
from service.database.engines import open_database
from tests.system.carm import CArm
from tests.system.conftest import CASE
from tests.system.service_process import PIN, Service
from tests.system.walk import lift, tilted_guide, until

Trial = dict[str, Any]
# What the procedure is about when it is killed, and within how many seconds of its beginning.
_SPANS_S = {"words": 0.5, "motion": 3.0, "image": 4.0}
_MOTION_MM = 1.0
_PATIENCE_S = 120.0  # for an arm that is seen again
_QUIET_S = 0.5  # after a start, at least: an arm that was to go on would have begun
_WHOLE_EVERY = 20  # starts


@dataclass
class KilledService(ForkedService):
    """Started whole at first and every twentieth time, forked otherwise."""

    _starts: int = field(init=False, default=-1)

    def start(self) -> None:
        """Start, and wait for the address."""
        self._starts += 1
        self._kind.start(self)

    def kill(self) -> None:
        """As a power switch would."""
        self._kind.kill(self)

    def end(self) -> None:
        """As an operator would."""
        self._kind.end(self)

    @property
    def started(self) -> str:
        """How the one that runs was."""
        return "started whole" if self._kind is Service else "forked"

    @property
    def _kind(self) -> type[Service]:
        return Service if self._starts % _WHOLE_EVERY == 0 else ForkedService


@dataclass
class Acknowledged:
    """What the service answered, and the statement that it was killed over."""

    events: list[tuple[int, str]] = field(default_factory=list)
    said: list[str] = field(default_factory=list)
    in_flight: tuple[str, dict[str, str]] | None = None  # words, headers


class Procedure:
    """One case, led on by one person until the service is gone."""

    def __init__(self, case: Case, carm: CArm, image: Any) -> None:
        self.case, self._carm, self._image = case, carm, image
        self.acknowledged = Acknowledged()
        self._up = True

    def run(self, about: str) -> None:
        """Go on until nobody answers."""
        step = {"words": self._words, "motion": self._motion, "image": self._expose}[about]
        try:
            while True:
                self._say()
                step()
        except (NoAnswer, OSError, TimeoutError):  # the kill, met by a request or by a held button
            return

    def say_again(self) -> None:
        """The statement in flight once more, under its key."""
        if self.acknowledged.in_flight is not None:
            self._post(*self.acknowledged.in_flight)

    def command(self, name: str, **body: Any) -> dict[str, Any]:
        """A command, kept with its event once it is acknowledged; refused where the arm or the case is not ready."""
        answer = self.case.command(name, **body)
        self.acknowledged.events.append((answer["sequence"], answer["taken_as"]))
        return answer

    def _say(self) -> None:
        words, headers = uuid4().hex, {"Idempotency-Key": uuid4().hex}
        self.acknowledged.in_flight = words, headers
        self._post(words, headers)

    def _post(self, words: str, headers: dict[str, str]) -> None:
        answer = self.case.room.post(f"/cases/{self.case.id}/note", {"text": words}, headers)
        self.acknowledged.events.append((answer["sequence"], "note"))
        self.acknowledged.said.append(words)
        self.acknowledged.in_flight = None

    def _words(self) -> None:
        self.case.status()
        self.command("patient-moved", what="coughed")
        self.command("hold-requested", reason="a pause")
        self._calm()

    def _motion(self) -> None:
        self._up = not self._up
        try:
            plan = lift(self.case, _MOTION_MM if self._up else -_MOTION_MM)
            with self.case.hold(self.case.approve(plan, PIN)) as hold:
                hold.wait(30.0)
        except Refused:  # a crowded machine lost the hold or the feedback
            pass
        self._calm()

    def _expose(self) -> None:
        self._calm()
        if self.case.status()["state"] == "case_open":
            self.command("carm-position-confirmed")
        self.command("exposure-requested")
        self._image.PixelData = np.random.default_rng().bytes(2) + self._image.PixelData[2:]
        self._carm.send(self._carm.sent_again(self._image))
        until(lambda: self.case.status()["state"] not in ("image_acquired", "carm_positioned"), _PATIENCE_S)
        if self.case.status()["state"] == "registered":
            self.command("retake", reason="another")

    def _calm(self) -> None:
        """Out of a hold, once the arm can be seen."""
        until(lambda: _is_calm(self.case), _PATIENCE_S)


class KilledRoom:
    """A service and a controller; the service is killed and started again."""

    def __init__(self, opened: ExitStack, folder: Path) -> None:
        nursery = Nursery()
        opened.callback(nursery.close)
        self.service, self.controller = serve_room(opened, folder, partial(KilledService, nursery=nursery))
        with self.service.sign_in() as client:
            case = client.open_case(CASE)
            case.command("guide-state-stated", guide="empty")
            self._case_id = case.id
        self._carm = CArm(self.service, str(CASE["patient_id"]), str(CASE["study_uid"]))
        self._image = self._carm.image(tilted_guide())
        self._clients = opened.enter_context(ExitStack())  # that of the service which runs
        self._case = self._signed_in()
        self._make_ready()

    def killed(self, number: int) -> Trial:
        """One kill; bad where something acknowledged is lost or there twice, or the arm moves afterwards."""
        random = Random(number)
        about, started = random.choice(list(_SPANS_S)), self.service.started
        procedure = self._kill_amid(about, random.uniform(0.0, _SPANS_S[about]))
        before = self._events()
        until(lambda: not self.controller.state().moving, _PATIENCE_S)
        stood_rad = np.array(self.controller.state().joints_rad)
        corrupt = look(self.service.folder)[1]
        self._start_again(procedure)
        moved = not np.array_equal(stood_rad, self.controller.state().joints_rad)
        said = corrupt or _against(procedure.acknowledged, before, self._events()) or "the arm moved" * moved
        kind = f"{about}, {before[-1].state}, {started}"
        acknowledged = len(procedure.acknowledged.events)
        return {"number": number, "kind": kind, "bad": bool(said), "acknowledged": acknowledged, "said": said}

    def _kill_amid(self, about: str, after_s: float) -> Procedure:
        """The procedure amid which the service was killed, so long after its beginning."""
        procedure = Procedure(self._case, self._carm, self._image)
        thread = threading.Thread(target=procedure.run, args=(about,))
        thread.start()
        time.sleep(after_s)
        self.service.kill()
        thread.join()
        self._clients.close()
        return procedure

    def _start_again(self, procedure: Procedure) -> None:
        """Say once more what was in flight, then wait until the arm is seen, calm, and free to move."""
        self.service.start()
        quiet_until_s = time.monotonic() + _QUIET_S
        self._case = procedure.case = self._signed_in()
        procedure.say_again()
        self._make_ready()
        time.sleep(max(0.0, quiet_until_s - time.monotonic()))

    def _signed_in(self) -> Case:
        return self._clients.enter_context(self.service.sign_in()).case(self._case_id)

    def _make_ready(self) -> None:
        """For the next procedure."""
        self._case.take_lease("the next procedure")
        until(lambda: _is_calm(self._case), _PATIENCE_S)

    def _events(self) -> list[StoredEvent]:
        """As they are on the disk."""
        database = open_database(self.service.database_url)
        try:
            with database.read() as connection:
                return list(store.all_events(connection, self._case_id))
        finally:
            database.close()


def _is_calm(case: Case) -> bool:
    """Whether the arm may move; a hold is acknowledged, as often as a crowded machine loses the feedback."""
    status = case.status()
    if status["state"] == "safe_hold" and status["allowed"]["acknowledged"]["allowed"]:
        with suppress(Refused):
            case.command("acknowledged", guide="empty")
    return bool(status["arm"]["phase"] == "idle" and status["state"] != "safe_hold")


def _against(acknowledged: Acknowledged, before: list[StoredEvent], after: list[StoredEvent]) -> str:
    """What is wrong with a record right after a kill, and after the next start."""
    if [event.sequence for event in after] != list(range(1, len(after) + 1)):
        return "numbers are missing or there twice"
    recorded = {event.sequence: event.trigger for event in after}
    lost = [one for one in acknowledged.events if recorded.get(one[0]) != one[1]]
    if lost:
        return f"acknowledged and lost: {lost}"
    if after[: len(before)] != before or after[len(before)].trigger != "restarted":
        return "what was recorded changed, or no restart behind it"
    words = [event.data["text"] for event in after if event.trigger == "note"]
    repeated = [one for one in acknowledged.said if words.count(one) != 1]
    return f"said once, recorded otherwise: {repeated}" if repeated else ""


def kills(_folder: Path, numbers: Sequence[int]) -> Iterator[Trial]:
    """Kills by number, of one service after the other over one case."""
    with TemporaryDirectory() as place, ExitStack() as opened:
        room = KilledRoom(opened, Path(place))
        for number in numbers:
            yield room.killed(number)

"""One sequence against one case: the case, its model, and the room as the sequence has made it."""

from collections.abc import Callable
from contextlib import ExitStack
from random import Random
from typing import Any
from uuid import uuid4

from benchmarks.states.images import Sender
from benchmarks.states.model import CHAIN, INSERTION, OVER, Model
from benchmarks.states.refusals import Refused, World, refusal
from benchmarks.states.requests import LISTED
from benchmarks.states.room import TARGET, Answer, Room
from robot.safety import SafetyState

_LINKS = dict(
    zip(CHAIN, ("view", "image", "registration", "target", "plan", "permit", "motion", "verification"), strict=True)
)
PLANNED_TARGET = str(TARGET["name"])
_WAY = (
    "case_open",
    "carm_positioned",
    "image_acquired",
    "registered",
    "target_chosen",
    "moving",
    "moved",
    "off_target",
    "verified",
    "inserting",
    "sleeve_inserted",
    "closed",
)


class Difference(Exception):  # noqa: N818  what the sequences look for, no error of theirs
    """The service did something else than the model."""


class Play:
    """A new case, and everything that its sequence has to remember."""

    def __init__(self, room: Room, devices: tuple[dict[str, str], dict[str, str]], random: Random, number: int) -> None:
        self.room, self.random, self.model = room, random, Model()
        self.requests = 0  # sent so far
        self.furthest = _WAY[0]
        self.devices = devices
        self.sender = Sender(f"P{number}-{uuid4().hex[:8]}", f"1.2.{uuid4().int % 10**12}")
        self.lease: tuple[str, int] | None = None  # who holds control, under which token
        self.version = 1
        self.images: list[str] = []  # ids; the model knows an image by its place
        self.pixels: list[int] = []  # of each
        self.work: list[tuple[str, int]] = []  # image work begun and not finished
        self.ids: dict[str, str] = {}  # newest of each kind
        self.taken: list[tuple[str, str, dict[str, Any], dict[str, str], Answer]] = []  # requests, as they were sent
        self.button = ExitStack()  # the connection of the held one
        room.guard.lock()
        self.case_id = self._opened()

    def _opened(self) -> str:
        body: dict[str, Any] = {
            "patient_id": self.sender.patient_id,
            "study_uid": self.sender.study_uid,
            "targets": [TARGET],
        }
        body |= {"devices": self.devices[0]}
        return str(self.send("POST", "/cases", "surgeon", body, Idempotency_Key=uuid4().hex).body["id"])

    @property
    def holder(self) -> str:
        """Who has control, or would take it."""
        return self.lease[0] if self.lease else "surgeon"

    @property
    def now_s(self) -> float:
        """By the monotonic clock of the room."""
        return self.room.clock.now_s

    def world(self, *, stale: bool = False) -> World:
        """The room as the interlocks see it."""
        readings = self.room.guard.readings
        return World(
            now_s=self.now_s,
            stale=stale,
            at_rest=readings.at_rest and self.model.state != "moving",
            safe=readings.safety in (SafetyState.NORMAL, SafetyState.REDUCED),
            program_running=readings.program_running,
            payload_right=readings.payload_kg is None,
        )

    def path(self, trigger: str) -> str:
        """Where a command of the case is sent."""
        return f"/cases/{self.case_id}/{trigger.replace('_', '-')}"

    def send(self, method: str, path: str, person: str, body: object = None, **headers: str) -> Answer:
        """One request of a person."""
        self.requests += 1
        return self.room.line.send(method, path, self.room.tokens[person], body, **headers)

    def expect(self, answer: Answer, expected: Refused | None) -> None:
        """The code, and of an interlock's refusal which ones failed."""
        if answer.code != (expected and expected[0]):
            raise Difference(f"answered {answer.status} {answer.body}, expected {expected}")
        if expected is not None and expected[0] == "interlock" and refusing(answer.body) != expected[1]:
            raise Difference(f"refused by {sorted(refusing(answer.body))}, expected {sorted(expected[1])}")

    def stopping(self, happens: Callable[[], None]) -> None:
        """What happens stops the arm, if it moves: the end of that motion is late news.

        Any statement stops an arm that moves before it is recorded; behind one that would let it go on comes the stop.
        """
        moved = self.model.state == "moving"
        happens()
        if not moved:
            return
        self.room.drift_known = False
        if self.model.state == "moving":
            self.model.held("stop")
        self.model.stays("missed")

    def compare(self) -> None:
        """The status of the case, once it has as many events as the model."""
        if self.model.state in INSERTION and self.room.guard.readings.program_running:
            self.model.held("fault")  # the service itself stops a program that runs while a sleeve is in
        status = self._status()
        self.version = status["version"]
        self.furthest = max(self.furthest, self.model.state, key=_how_far)
        found, expected = _seen(status), self._modelled()
        differing = {key: (found[key], expected[key]) for key in found if found[key] != expected[key]}
        if differing:
            raise Difference(f"service, model: {differing}")
        if self.model.state != "moving":
            self.button.close()

    def compare_record(self) -> None:
        """The whole record, event by event."""
        record = self.send("GET", f"/cases/{self.case_id}/audit", "surgeon").body
        found = [(event["sequence"], event["trigger"], event["state"]) for event in record]
        expected = [(number, *event) for number, event in enumerate(self.model.recorded, 1)]
        if found != expected:
            raise Difference(f"the record is {found}, expected {expected}")

    def leave(self) -> None:
        """After a difference: nothing of this case may reach into the next."""
        self.button.close()
        self.send("POST", self.path("case_aborted"), "surgeon", {"reason": "differed"})
        for _ in self.work:
            if self.room.wait(lambda: self.room.vision.is_at_work):
                self.room.vision.finish("refused")

    def _modelled(self) -> dict[str, Any]:
        model, sleeve, world = self.model, self.model.sleeve, self.world()
        return {
            "state": model.state,
            "events": len(model.recorded),
            "guide": model.guide,
            "chain": "".join(letter for letter in CHAIN if model.has(letter)),
            "insertion": sleeve and (sleeve.status, sleeve.verified, sleeve.flagged),
            "corrections": model.corrections,
            "images": model.images,
            "permitted": {name for name in LISTED if refusal(model, name, world, None) is None},
        }

    def _status(self) -> dict[str, Any]:
        """Once the service has recorded as much as the model."""
        status: dict[str, Any] = {}

        def came() -> bool:
            nonlocal status
            status = self.send("GET", f"/cases/{self.case_id}/status", "surgeon").body
            return bool(status["sequence"] >= len(self.model.recorded))

        if not self.room.wait(came):
            raise Difference(f"not recorded: {self.model.recorded[status['sequence'] :]}")
        return status


def refusing(problem: dict[str, Any]) -> frozenset[str]:
    """The interlocks that a refusal names."""
    return frozenset(one["code"] for one in problem["verdicts"] if not one["passed"])


def is_over(play: Play) -> bool:
    """Whether the case has ended."""
    return play.model.state in OVER


def _seen(status: dict[str, Any]) -> dict[str, Any]:
    insertion = status["insertion"]
    return {
        "state": status["state"],
        "events": status["sequence"],
        "guide": status["guide"],
        "chain": "".join(letter for letter in CHAIN if status["chain"][_LINKS[letter]] is not None),
        "insertion": insertion and (insertion["status"], insertion["verified"], insertion["flagged"]),
        "corrections": status["corrections"],
        "images": status["images"],
        "permitted": {name for name, one in status["allowed"].items() if one["allowed"]},
    }


def _how_far(state: str) -> int:
    return _WAY.index(state) if state in _WAY else -1

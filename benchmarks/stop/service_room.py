"""The whole service over a controller, pressed by clients over HTTP: release, stop, SIGKILL, and what must not stop."""

import time
from contextlib import ExitStack, suppress
from pathlib import Path
from types import TracebackType
from typing import Self

import numpy as np

from benchmarks.stop.forked_service import ForkedService, Nursery
from benchmarks.stop.jitter import jittering
from benchmarks.stop.load import Load
from benchmarks.stop.precedence import ahead, put_ahead
from benchmarks.stop.results import Trial
from benchmarks.stop.wire import Wire
from coaxial_client import Coaxial, NoAnswer, Refused
from service.auth.permissions import Role
from simulator.controller import ControllerProcess, ControllerSettings, Payload, free_loopback_address
from tests.databases import SqliteFiles
from tests.system.carm import CArm
from tests.system.conftest import CASE, add_users, prepare, upload_devices
from tests.system.service_process import PASSWORD, PIN, Service
from tests.system.walk import Walk, lift, lifting, until

_WAY_MM = 12.0
_SPAN_MM = 40.0
_WHOLE_EVERY = 20
_NOT_BEGUN = ("refused", "not_started")  # how a hold ends whose motion nothing had to stop
# Stops are pressed in these, one leading to the next.
_OFTEN = ("moving", "safe_hold", "case_open", "safe_hold")
_ELSEWHERE = (
    "carm_positioned",
    "image_acquired",
    "registered",
    "target_chosen",
    "moved",
    "off_target",
    "verified",
    "inserting",
    "sleeve_inserted",
    "over",
)


class ServiceRoom:
    """One service and one controller, used trial by trial; the tablet perhaps behind a network that jitters."""

    def __init__(self, folder: Path, load: Load, *, jitters: bool = False, forks: bool = False) -> None:
        self._folder = folder
        self._load = load
        self._jitters = jitters
        self._forks = forks

    def __enter__(self) -> Self:
        flange_from_tcp = np.eye(4)
        flange_from_tcp[2, 3] = 150.0
        with ExitStack() as opened, self._load.paused():
            settings = ControllerSettings(free_loopback_address(), flange_from_tcp=flange_from_tcp, payload=Payload())
            self._controller = opened.enter_context(ControllerProcess(settings))
            put_ahead(self._controller.pid)
            self._wire = Wire(self._controller)
            self._folder.mkdir(parents=True)
            database_url = opened.enter_context(SqliteFiles(self._folder.parent).migrated(self._folder))
            whole = Service(self._folder, self._controller.address, database_url)
            self._services = [whole, *self._forked(opened, database_url)]
            add_users(database_url)
            self._service = whole
            whole.start()
            opened.callback(lambda: self._service.end())
            self._sign_in(opened)
            self._carm = CArm(self._service, str(CASE["patient_id"]), str(CASE["study_uid"]))
            self._case = prepare(self._room.open_case(CASE))
            self._lowest_mm = self._height_mm()
            self._opened = opened.pop_all()
        return self

    def _sign_in(self, opened: ExitStack) -> None:
        """The surgeon, perhaps from behind the network, and a client of each role that may press stop."""
        with ahead():
            url = opened.enter_context(jittering(self._service.url)) if self._jitters else self._service.url
        self._room = Coaxial(url)
        self._room.sign_in("surgeon", PASSWORD)
        upload_devices(self._room)
        self._pressers = [self._service.sign_in(role.value) for role in Role]

    def _forked(self, opened: ExitStack, database_url: str) -> list[ForkedService]:
        """The same service as it starts where it is killed again and again: the imports would take hours."""
        if not self._forks:
            return []
        nursery = Nursery()
        opened.callback(nursery.close)
        return [ForkedService(self._folder, self._controller.address, database_url, nursery=nursery)]

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, at: TracebackType | None) -> None:
        self._opened.close()

    def release(self, _: int) -> Trial:
        """The hand lets go: from the message to the wire."""
        self._wire.mark()
        with ahead(), lifting(self._case, self._controller, self._way_mm()) as hold:
            at_s = time.monotonic()
            hold.release()
            ended = hold.wait(10.0)
        late_ms = self._wire.first_stop_ms(at_s)
        self._calm()
        return Trial(late_ms, ended.cause == "released", "moving")

    def stop(self, number: int) -> Trial:
        """A client of each role in turn: from the request to the wire."""
        state = _OFTEN[number % len(_OFTEN)]
        presser = self._pressers[number // len(_OFTEN) % len(self._pressers)]
        if state != "moving":
            self._come_to(state)
            return self._pressed_at_rest(presser, state)
        self._calm()
        self._wire.mark()
        with ahead(), lifting(self._case, self._controller, self._way_mm()):
            return self._pressed(presser, state)

    def stop_elsewhere(self, number: int) -> Trial:
        """The same in the states that it takes images to reach, and without a case."""
        state = _ELSEWHERE[number % len(_ELSEWHERE)]
        with self._load.paused():
            self._come_to(state)
        trial = self._pressed_at_rest(self._pressers[number % len(self._pressers)], state)
        self._new_case()
        return trial

    def kill_service(self, number: int) -> Trial:
        """SIGKILL of the service amid a motion: from the signal to the wire. The next is forked, or started whole."""
        self._wire.mark()
        killed = "started whole" if self._service is self._services[0] else "forked"
        with lifting(self._case, self._controller, self._way_mm()):
            at_s = time.monotonic()
            self._service.kill()
        late_ms = self._wire.first_stop_ms(at_s)
        self._service = self._services[0 if number % _WHOLE_EVERY == 0 else -1]
        with self._load.paused():
            self._service.start()
            self._room = self._service.sign_in()
            self._case = self._room.case(self._case.id)
            self._case.take_lease("after the kill")
            self._calm()
        return Trial(late_ms, late_ms is not None, killed)

    def nuisance(self, _: int) -> Trial:
        """A held motion that is to arrive, the tablet behind a network that jitters."""
        try:
            permit = self._case.approve(lift(self._case, self._way_mm()), PIN)
        except Refused:  # an arm or a guard that was not heard of in time: nothing was held yet
            self._calm()
            return Trial(None, False, "refused", counts=False)
        with ahead(), self._case.hold(permit) as hold:
            try:
                cause = hold.wait(20.0).cause
            except (TimeoutError, NoAnswer):
                cause = "connection lost"
        self._calm()
        return Trial(None, cause == "arrived", cause, counts=cause not in _NOT_BEGUN)

    def _pressed_at_rest(self, presser: Coaxial, state: str) -> Trial:
        self._wire.mark_when_quiet()
        with ahead():
            return self._pressed(presser, state)

    def _pressed(self, presser: Coaxial, state: str) -> Trial:
        at_s = time.monotonic()
        try:
            accepted = bool(presser.stop()["sent_to_guard"])
        except Refused:
            accepted = False
        return Trial(self._wire.first_stop_ms(at_s), accepted, state)

    def _come_to(self, state: str) -> None:
        if state == "safe_hold":
            if self._case.status()["state"] != state:
                self._room.stop()
            self._case.wait_for(state)
            return
        self._calm()
        if state == "over":
            self._case.command("case-aborted", reason="a trial")
        elif state != "case_open":
            Walk(self._case, self._carm).to(state)

    def _calm(self) -> None:
        """A case that may move again."""
        until(lambda: self._case.status()["arm"]["connected"], 60.0)
        until(self._is_calm, 60.0)

    def _is_calm(self) -> bool:
        """Whether the case may move; acknowledged as often as a crowded machine has the arm held."""
        status = self._case.status()
        if status["state"] == "safe_hold":
            with suppress(Refused):  # an arm that is not heard of just now
                self._case.command("acknowledged", guide="empty")
        return status["state"] in ("case_open", "carm_positioned") and status["arm"]["phase"] == "idle"

    def _new_case(self) -> None:
        if self._room.status()["open_case"] is not None:
            self._case.command("case-aborted", reason="a trial")
        self._case = prepare(self._room.open_case(CASE))

    def _way_mm(self) -> float:
        return _WAY_MM if self._height_mm() < self._lowest_mm + _SPAN_MM else -_WAY_MM

    def _height_mm(self) -> float:
        return float(self._controller.state().base_from_flange_nominal[2, 3])

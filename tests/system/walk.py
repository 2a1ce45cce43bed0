"""The way of a case through the procedure, the C-arm seeing the guide where the motions bring it."""

from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coaxial_client import Case, Hold
from simulator.controller import ControllerProcess
from tests.system.carm import CArm
from tests.system.service_process import PIN
from tests.waiting import until


def tilted_guide() -> np.ndarray:
    """source_from_guide of a guide 750 mm from the source, tilted by 8 deg: a plain view of it."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_euler("xy", [8.0, -3.0], degrees=True).as_matrix()
    pose[:3, 3] = [10.0, -5.0, 750.0]
    return pose


class Held(Exception):  # noqa: N818  a turn of the procedure, no error of the tests
    """The case went into safe_hold on its way."""


class Walk:
    """Leads a case from state to state, the C-arm seeing the guide where the motions bring it."""

    target_px = (560.0, 470.0)

    def __init__(self, case: Case, carm: CArm) -> None:
        self.case = case
        self.carm = carm
        self.source_from_guide = tilted_guide()

    def to(self, state: str) -> dict:
        """From case_open to a state of the plain way, off_target and safe_hold included; its status.

        A crowded machine may lose the feedback or the hold for a moment, which holds the case: the way is gone anew.
        """
        for _ in range(4):
            try:
                self._go(state)
                return self.case.wait_for(state)
            except Held:
                until(lambda: self.case.status()["arm"]["connected"])
                self.case.command("acknowledged", guide="empty")
                self.case.command("patient-moved", what="nothing: the way is gone anew")
        pytest.fail("the machine is too busy for a procedure")

    def _go(self, state: str) -> None:
        way = ["carm_positioned", "registered", "target_chosen", "moved", "verified", "inserting", "sleeve_inserted"]
        beside = {"off_target": "moved", "safe_hold": "carm_positioned", "image_acquired": "carm_positioned"}
        goal = beside.get(state, state)
        for step in way[: way.index(goal) + 1] if goal in way else []:
            getattr(self, step)()
        if state == "off_target":
            self.off_target()
        if state == "image_acquired":
            self.case.command("exposure-requested")
            self.carm.expose(self.source_from_guide)
        if state == "safe_hold":
            self.case.stop()

    def _comes(self, state: str) -> None:
        until(lambda: self.case.status()["state"] in (state, "safe_hold"), 90.0)
        if self.case.status()["state"] == "safe_hold":
            raise Held(self.case.status()["held_for"])

    def carm_positioned(self) -> None:
        self.case.command("carm-position-confirmed")

    def registered(self) -> None:
        self.case.command("exposure-requested")
        self.carm.expose(self.source_from_guide)
        self._comes("registered")

    def target_chosen(self, planned_target: str | None = "L3 left") -> None:
        echo = self.case.echo(self.case.status()["chain"]["image"], self.target_px)
        answer = self.case.command("target-confirmed", echo_id=echo["echo_id"], planned_target=planned_target)
        self._aim(answer)

    def moved(self, kind: str = "targeting", **goal: object) -> None:
        plan = self.case.plan(kind, **goal)
        with self.case.hold(self.case.approve(plan, PIN)) as hold:
            cause = hold.wait(60.0).cause
        if cause in ("heartbeat_lost", "feedback_lost"):
            raise Held(cause)
        assert cause == "arrived"

    def verified(self) -> None:
        self._verify(self.aimed)
        self._comes("verified")

    def off_target(self) -> None:
        self._verify(self.aimed @ _shifted(3.0))
        self._comes("off_target")

    def corrected(self) -> None:
        self._aim(self.case.command("correction-requested"))
        self.moved("corrective")

    def inserting(self) -> None:
        self.case.command("insertion-started", pin=PIN)

    def sleeve_inserted(self) -> None:
        self.case.command("sleeve-in")

    def _verify(self, source_from_guide: np.ndarray) -> None:
        self.case.command("exposure-requested")
        self.source_from_guide = source_from_guide
        self.carm.expose(source_from_guide)

    def _aim(self, answer: dict) -> None:
        self.aimed = self.source_from_guide @ np.array(answer["detail"]["targeting"]["guide_from_goal"])


def _shifted(mm: float) -> np.ndarray:
    shift = np.eye(4)
    shift[0, 3] = mm
    return shift


def lift(case: Case, mm: float = 40.0) -> dict:
    """A plan straight up from where the arm is."""
    pose = np.array(case.status()["arm"]["base_from_tcp"])
    vector_deg = np.rad2deg(Rotation.from_matrix(pose[:3, :3]).as_rotvec())
    goal = {"translation_mm": list(pose[:3, 3] + [0.0, 0.0, mm]), "rotation_vector_deg": list(vector_deg)}
    return case.plan("approach", base_from_goal=goal)


@contextmanager
def lifting(case: Case, controller: ControllerProcess, mm: float) -> Iterator[Hold]:
    """A motion straight up that is under way. A crowded machine may lose the hold; then the hand presses again."""
    for _ in range(4):
        with case.hold(case.approve(lift(case, mm), PIN)) as hold:
            until(lambda hold=hold: controller.state().tcp_speed_mm_s > 10.0 or hold.is_over)
            if not hold.is_over:
                yield hold
                return
        if case.wait_for("safe_hold", "case_open")["state"] == "safe_hold":
            until(lambda: case.status()["arm"]["base_from_tcp"] is not None)
            case.command("acknowledged", guide="empty")
    pytest.fail("the machine is too busy to hold a button for a second")

"""The procedure as the team walks it: hands on the tablet, and the radiographer's hands at the C-arm of the room."""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import pytest
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from coaxial_client import Case
from simulator.demo.door_client import Door
from simulator.demo.legs import legs
from tests.tablet.hand import GoneError
from tests.tablet.tablet import Tablet

_MOTION_S = 90.0
_IMAGE_S = 120.0
_FIELDS = ("x", "y", "z", "rx", "ry", "rz")
_CLEARANCE = "45"
_TRIES = 5
# How a crowded machine ends a hold; whatever else ends one fails the test.
_LOST = (
    "the hold was lost",
    "the link to the arm was lost",
    "no live hold",
    "nothing moved",
    "the controller's clock does not advance",
    "the arm's feedback is old",
    "the arm's joints were not read again",
)


@dataclass(frozen=True)
class Walk:
    """One surgeon's tablet at one case; `case` only reads what a person would read off the room's own displays."""

    tablet: Tablet
    case: Case
    door: Door
    pin: str
    look: Callable[[str], None]

    def begin(self) -> None:
        """Into the open case, control taken, the guide stated empty."""
        self.tablet.press("Enter the case")
        self.tablet.page.locator("main[data-state]").wait_for()
        self.tablet.take_control()
        self._come_to(self._read_angles, "case_open")
        self._read_angles()  # after a hold they may still be on their way
        self.look("case_open")
        self.tablet.hand.tap("State a fact")
        self.look("facts")
        self.tablet.hand.tap("The guide is empty")
        self.tablet.page.locator(".guide.is-empty").wait_for()

    def _read_angles(self) -> None:
        """How the C-arm is to stand."""
        self.tablet.page.locator(".dials, main[data-state=safe_hold]").first.wait_for(timeout=_IMAGE_S * 1000)

    def turn_carm(self, pedicle: str) -> None:
        """The C-arm stands in the view of a planned path."""
        angles = self.case.carm_angles(pedicle)
        self.door.position_carm(angles["primary_angle_deg"], angles["secondary_angle_deg"], pedicle)
        self._come_to(lambda: self.tablet.press("The C-arm stands"), "carm_positioned")

    def bring_guide_in(self, pedicle: str) -> None:
        """In as many motions as the service asks for, each entered, planned, approved and held."""
        start = np.array(self.case.status()["arm"]["base_from_tcp"])
        for goal in legs(start, self.door.approach_to(pedicle)):
            pose = [*goal["translation_mm"], *goal["rotation_vector_deg"]]
            self.go(lambda pose=pose: self._plan_approach(pose))

    def image(self, words: str, *states: str) -> None:
        """Ask for an exposure on the tablet, press the pedal in the room, and wait for what comes of the image."""
        self._come_to(lambda: self._expose(words), *states)

    def _come_to(self, step: Callable[[], None], *states: str) -> None:
        """Do what leads to one of these states.

        A crowded machine may lose the arm's feedback meanwhile; what is made of an image then is there after the hold.
        """
        for _ in range(_TRIES):
            try:
                step()
            except (PlaywrightTimeoutError, GoneError):
                if not self._is_held():
                    raise
            if self._seen_at(*states, "safe_hold") != "safe_hold":
                return
            self._leave_hold()
            if self._is_soon_at(*states):
                return
        pytest.fail(f"the machine is too busy to come to {states}")

    def _expose(self, words: str) -> None:
        self.tablet.press(words)
        self.tablet.page.get_by_text("Expose now").wait_for()
        self.look("exposing")
        self.door.expose()

    def _seen_at(self, *states: str) -> str:
        screens = self.tablet.page.locator(", ".join(f"main[data-state={state}]" for state in states))
        screens.wait_for(timeout=_IMAGE_S * 1000)
        return screens.get_attribute("data-state") or ""

    def _is_soon_at(self, *states: str) -> bool:
        try:
            self.tablet.page.locator(", ".join(f"main[data-state={state}]" for state in states)).wait_for(
                timeout=10_000
            )
        except PlaywrightTimeoutError:
            return False
        return True

    def choose(self, pixel_px: tuple[float, float]) -> None:
        """A point of the image, looked at as the service understood it, and confirmed."""
        self._come_to(lambda: self._pick(pixel_px), "target_chosen")

    def correct(self) -> None:
        """Once more, from what the verification measured."""
        self._come_to(self._ask_for_correction, "target_chosen")

    def _ask_for_correction(self) -> None:
        self.tablet.press("Correct the aim")
        self.tablet.hand.tap("Error and bound exceed the limits")

    def _pick(self, pixel_px: tuple[float, float]) -> None:
        at = self.tablet.screen_of(pixel_px)
        self.tablet.hand.put_down([at])
        self.look("loupe")
        self.tablet.hand.lift()
        self.tablet.page.get_by_role("button", name="Confirm this target").wait_for()
        self.look("registered")
        self.tablet.press("Confirm this target")

    def go(self, plan: Callable[[], None], picture: str = "") -> None:
        """Plan, approve and hold until the arm has arrived.

        A crowded machine may lose the hold, as any room may: then it is looked at, acknowledged, planned and held anew.
        """
        for _ in range(_TRIES):
            try:
                plan()
                ended = self._approve_and_hold(picture)
            except (PlaywrightTimeoutError, GoneError):
                if not self._is_held():
                    raise
                self._leave_hold()
                continue
            self.tablet.hand.tap("Understood")
            if ": arrived" in ended:
                return
            assert any(lost in ended for lost in _LOST), ended
            self._leave_hold()
        pytest.fail("the machine is too busy to hold a button")

    def _approve_and_hold(self, picture: str) -> str:
        """The plan read, the PIN, the button held; the words that say how it ended."""
        page, hand = self.tablet.page, self.tablet.hand
        page.get_by_role("button", name="Approve with PIN").wait_for(timeout=30_000)
        assert not page.locator(".hold").is_visible(), "nothing is held before the PIN"
        self.look(f"plan{picture}")
        self._approve()
        button = page.locator(".hold")
        self.look(f"hold{picture}")  # before it is held: a picture takes the page longer than a heartbeat may be late
        with hand.touching([hand.middle_of(button)]):
            page.locator(".ended").wait_for(timeout=_MOTION_S * 1000)
            return page.locator(".ended").inner_text()

    def _approve(self) -> None:
        """With the PIN, again where the arm was not read in time."""
        page = self.tablet.page
        refused = page.locator(".banner.is-refusal")
        for _ in range(_TRIES):
            self.tablet.press("Approve with PIN")
            self.look("pin")
            self.tablet.hand.enter(self.pin)
            page.locator(".hold").or_(refused).first.wait_for()
            if not refused.is_visible():
                return
            words = refused.inner_text()
            assert any(lost in words for lost in _LOST), words
            self.tablet.hand.tap(refused.get_by_role("button", name="Close"))
        pytest.fail("the machine is too busy to read the arm")

    def _leave_hold(self) -> None:
        self.tablet.page.wait_for_timeout(1000)  # the fault is told after the motion's own end
        if self._is_held():
            self.look("held")
            self.tablet.leave_hold()

    def _is_held(self) -> bool:
        return self.tablet.page.locator("main[data-state=safe_hold]").is_visible()

    def insert(self) -> None:
        """The arm locked, the sleeve in and out again."""
        self._come_to(self._lock, "inserting")
        self.look("inserting")
        self.tablet.press("The sleeve is in")
        self.tablet.is_at("sleeve_inserted")
        self.look("sleeve_inserted")
        self.tablet.press("The sleeve is out, the guide is empty")
        self.tablet.press("Target done")

    def _lock(self) -> None:
        self.tablet.press("Lock the arm and insert")
        self.tablet.hand.enter(self.pin)

    def retreat(self) -> None:
        """Along the guide's axis, clear of the patient."""
        self.go(self._plan_retreat)

    def close(self) -> None:
        """Signed with the PIN."""
        self.tablet.hand.tap("More", exact=True)
        self.look("more")
        self.tablet.hand.tap(self.tablet.page.locator(".drawer").get_by_role("button", name="Close the case"))
        self.tablet.hand.enter(self.pin)
        self.tablet.is_at("closed")

    def _plan_approach(self, pose: Sequence[float]) -> None:
        self.tablet.hand.tap("Move the arm nearer or away")
        for name, number in zip(_FIELDS, pose, strict=True):
            self.tablet.hand.tap(self.tablet.page.locator(f"[data-field={name}]"))
            self.tablet.hand.enter(f"{number:.2f}")
        self.look("approach")
        self.tablet.hand.tap("Plan the motion")

    def _plan_retreat(self) -> None:
        self.tablet.hand.tap(self.tablet.page.get_by_role("button", name=re.compile("^Move the arm")))
        self.tablet.hand.tap(self.tablet.page.get_by_role("tab", name="Retreat"))
        self.tablet.hand.tap(self.tablet.page.locator("[data-field=distance]"))
        self.tablet.hand.enter(_CLEARANCE)
        self.tablet.hand.tap(self.tablet.page.locator(".bringing").get_by_role("button", name="Plan the motion"))

"""Each way of losing a held button stops the arm: seen at the arm itself, by what the room tells of it."""

import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import httpx
import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coaxial_client import Case
from simulator.demo.stage import Stage
from tests.tablet.cable import Cable, cable_to
from tests.tablet.tablet import Tablet
from tests.waiting import until

pytestmark = pytest.mark.lengthy

_WAY_MM = 130.0  # from its middle on still three seconds of motion
_SHORT_MM = 5.0  # an arm that stops so far from its goal was stopped
_STANDS_S = 0.5
_TRIES = 5
_STUCK_MS = 1500
_READ = "() => import('/js/case/live.js').then(live => live.readStatus())"
_PLAN = "goal => import('/js/move/motion.js').then(move => move.plan('approach', {base_from_goal: goal}))"
_APPROVE = "pin => import('/js/move/motion.js').then(move => move.motion.value && move.approve(move.motion.value, pin))"


@dataclass(frozen=True)
class Held:
    """A tablet whose button is held, the arm under way to its goal."""

    tablet: Tablet
    cable: Cable
    goal_mm: np.ndarray


@pytest.fixture(scope="module")
def ends(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """Two poses between which the arm goes to and fro."""
    here = np.array(case.status()["arm"]["base_from_tcp"])
    there = here.copy()
    there[1, 3] += _WAY_MM
    return here, there


@pytest.fixture
def held(stage: Stage, case: Case, ends, open_tablet: Callable[..., Tablet]) -> Iterator[Held]:
    with cable_to(stage.url) as cable:
        tablet = open_tablet(cable.url)
        tablet.sign_in("surgeon", stage.people["surgeon"].pin)
        tablet.press("Enter the case")
        tablet.page.locator("main[data-state]").wait_for()
        tablet.take_control()
        yield Held(tablet, cable, _set_out(tablet, stage, case, ends))
        tablet.complaints.clear()  # what the browser says of a network that was cut is no complaint of the page


def _set_out(tablet: Tablet, stage: Stage, case: Case, ends) -> np.ndarray:
    """Hold until the arm is under way; a crowded machine may lose the first beats. Where it goes, base frame, mm."""
    ended = tablet.page.locator(".ended")
    for _ in range(_TRIES):
        tablet.leave_hold()
        tablet.state_fact("The guide is empty")
        goal = _farther(ends, np.array(case.status()["arm"]["base_from_tcp"]))
        if not _approve(tablet, goal, stage.people["surgeon"].pin):
            continue
        tablet.hand.put_down([tablet.hand.middle_of(tablet.page.locator(".hold"))])
        until(lambda: _arm(stage)["moving"] or ended.is_visible())
        if not ended.is_visible():
            return goal[:3, 3]
        tablet.hand.lift()
        tablet.hand.tap("Understood")
    pytest.fail("the machine is too busy to hold a button")


def _farther(ends: tuple[np.ndarray, np.ndarray], pose: np.ndarray) -> np.ndarray:
    here, there = ends
    return there if pose[1, 3] - here[1, 3] < _WAY_MM / 2 else here


def _approve(tablet: Tablet, goal: np.ndarray, pin: str) -> bool:
    """Planned and approved by the page's own modules, six numbers on a keypad are another test's; whether the button is
    there then."""
    turn_deg = Rotation.from_matrix(goal[:3, :3]).as_rotvec(degrees=True)
    tablet.page.evaluate(_READ)
    tablet.page.evaluate(_PLAN, {"translation_mm": goal[:3, 3].tolist(), "rotation_vector_deg": turn_deg.tolist()})
    tablet.page.evaluate(_APPROVE, pin)
    tablet.page.locator(".hold, main[data-state=safe_hold]").first.wait_for()
    return tablet.page.locator(".hold").is_visible()


def _arm(stage: Stage) -> dict[str, object]:
    """The arm as the room sees it, not as the service says."""
    told: dict[str, object] = httpx.get(f"{stage.door.url}/arm", trust_env=False).raise_for_status().json()
    return told


def _say(event: str, target: str = "window") -> Callable[[Held], None]:
    return lambda held: held.tablet.page.evaluate(f"{target}.dispatchEvent(new Event('{event}'))")


def _hide(held: Held) -> None:
    """As a call or the screen lock does."""
    held.tablet.page.evaluate(
        "Object.defineProperty(document, 'visibilityState', {value: 'hidden', configurable: true});"
        "document.dispatchEvent(new Event('visibilitychange'))"
    )


def _another_page(held: Held) -> None:
    """One that comes to the front; Playwright, unless told not to, has every page believe that it has the focus."""
    page = held.tablet.page
    page.context.new_cdp_session(page).send("Emulation.setFocusEmulationEnabled", {"enabled": False})
    page.context.new_page().bring_to_front()


def _second_finger(held: Held) -> None:
    hand = held.tablet.hand
    hand.put_down([hand.middle_of(held.tablet.page.locator(".hold")), (40.0, 300.0)])


def _press_stop(held: Held) -> None:
    """With another finger, the first still down."""
    hand, page = held.tablet.hand, held.tablet.page
    hand.put_down([hand.middle_of(page.locator(".hold")), hand.middle_of(page.locator(".stop"))])
    page.get_by_text("Stop sent").wait_for()
    page.get_by_text("Stop was pressed").wait_for()


def _slip(held: Held) -> None:
    x, y = held.tablet.hand.middle_of(held.tablet.page.locator(".hold"))
    held.tablet.hand.move([(x, y - 200.0)])


def _stick(held: Held) -> None:
    held.tablet.page.evaluate(
        f"() => {{ const end = performance.now() + {_STUCK_MS}; while (performance.now() < end); }}"
    )


# How it is lost, and what the page says of it where it is still there to say anything.
WAYS: dict[str, tuple[Callable[[Held], object], str]] = {
    "released": (lambda held: held.tablet.hand.lift(), "released"),
    "touch cancelled": (lambda held: held.tablet.hand.cancel(), "The touch was cancelled"),
    "second finger": (_second_finger, "A second finger"),
    "slipped off": (_slip, "slipped off"),
    "focus lost": (_say("blur"), "lost the focus"),
    "another page in front": (_another_page, "lost the focus"),
    "hidden": (_hide, "was hidden"),
    "page hidden for good": (_say("pagehide"), "The page was left"),
    "page frozen": (_say("freeze", "document"), "The page was left"),
    "page stuck": (_stick, "the hold was lost"),
    "page left": (lambda held: held.tablet.page.goto("about:blank"), ""),
    "page closed": (lambda held: held.tablet.page.close(), ""),
    "network told lost": (lambda held: held.tablet.page.context.set_offline(True), "The network was lost"),
    "network cut": (lambda held: held.cable.cut(), ""),
    "stop pressed": (_press_stop, ""),  # the second finger lets go, too, and either may reach the guard first
}


@pytest.mark.parametrize("way", WAYS)
def test_the_arm_stops(held, stage, case, way):
    lose, words = WAYS[way]
    lose(held)
    until(lambda: not _arm(stage)["moving"])
    joints_deg = _arm(stage)["joints_deg"]
    until(lambda: case.status()["state"] in ("case_open", "safe_hold"))
    time.sleep(_STANDS_S)
    assert _arm(stage)["joints_deg"] == joints_deg
    stands_mm = np.array(case.status()["arm"]["base_from_tcp"])[:3, 3]
    assert np.linalg.norm(stands_mm - held.goal_mm) > _SHORT_MM
    if words:
        held.tablet.page.locator(".ended", has_text=words).wait_for()


def test_a_finger_that_is_lifted_after_the_motion_presses_nothing(held, stage):
    held.tablet.page.evaluate("addEventListener('click', () => (document.title = 'pressed'), true)")
    held.tablet.page.locator(".ended").wait_for()
    held.tablet.hand.lift()
    held.tablet.page.wait_for_timeout(500)
    assert held.tablet.page.title() == "Coaxial"

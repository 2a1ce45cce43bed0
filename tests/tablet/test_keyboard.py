"""The arm planned, approved and moved by a keyboard alone: no mouse, no touch."""

from collections.abc import Callable

import numpy as np
import pytest
from playwright.sync_api import Page
from scipy.spatial.transform import Rotation

from coaxial_client import Case
from simulator.demo.stage import Stage
from tests.tablet.tablet import Tablet

pytestmark = pytest.mark.lengthy

_MOST_TABS = 80
_TRIES = 5  # a crowded machine loses a hold, or the reading of the arm
_STEP_MM = 30.0
_ARRIVED_MS = 60_000.0
# What somebody would read of the element that has the focus; the page as a whole, behind its last element, is none.
_FOCUSED = """() => {
    const one = document.activeElement;
    if (one === document.body) return "";
    const field = one.dataset.field && `field ${one.dataset.field};`;
    return [one.ariaLabel, one.innerText, one.labels?.[0]?.innerText, field].filter(Boolean).join(" | ");
}"""


def _go_to(page: Page, words: str) -> None:
    """Tab until the focus is on what bears these words."""
    for _ in range(_MOST_TABS):
        page.keyboard.press("Tab")
        if words in page.evaluate(_FOCUSED):
            return
    pytest.fail(f"the keyboard does not reach {words!r}")


def _press(page: Page, words: str) -> None:
    """Press what bears these words, once it is there."""
    page.locator("button:not([disabled])", has_text=words).first.wait_for()
    _go_to(page, words)
    page.keyboard.press("Enter")


@pytest.fixture
def page(open_tablet: Callable[..., Tablet], stage: Stage, case: Case) -> Page:
    """Signed in, in the case, with control, the guide stated empty."""
    tablet, surgeon = open_tablet(stage.url, has_touch=False), stage.people["surgeon"]
    page = tablet.page
    page.goto(stage.url)
    page.get_by_label("Name").wait_for()
    _go_to(page, "Name")
    page.keyboard.type("surgeon")
    _go_to(page, "1\n2\n3")  # the keypad, by what stands on it
    page.keyboard.type(surgeon.pin)
    page.keyboard.press("Enter")
    _press(page, "Enter the case")
    page.locator("main[data-state]").wait_for()
    _go_to(page, "Control of the case")
    page.keyboard.press("Enter")
    page.locator(".control.is-yours").wait_for()
    return page


def _enter_goal(page: Page, goal: np.ndarray) -> None:
    """Six numbers on the form of an approach, and the plan asked for."""
    if page.locator(".bringing [aria-expanded=false]").is_visible():
        _press(page, "Move the arm nearer or away")
    turn_deg = Rotation.from_matrix(goal[:3, :3]).as_rotvec(degrees=True)
    for name, value in zip(("x", "y", "z", "rx", "ry", "rz"), (*goal[:3, 3], *turn_deg), strict=True):
        _go_to(page, f"field {name};")
        page.keyboard.press("Enter")
        page.keyboard.type(f"{value:.2f}")
        page.keyboard.press("Enter")
    _press(page, "Plan the motion")


def _approve(page: Page, pin: str) -> bool:
    """With the PIN, where there is a plan; whether the button to hold is there then."""
    refused = page.locator(".banner.is-refusal, main[data-state=safe_hold]")
    approve = page.locator("button:not([disabled])", has_text="Approve with PIN")
    approve.or_(refused).first.wait_for()
    if refused.first.is_visible():
        return False
    _press(page, "Approve with PIN")
    page.keyboard.type(pin)
    page.keyboard.press("Enter")
    page.locator(".hold").or_(refused).first.wait_for()
    return page.locator(".hold").is_visible()


def _hold(page: Page) -> str:
    """Hold the space bar; how it ended in words."""
    _go_to(page, "Press and hold")
    page.keyboard.down("Space")
    page.locator(".ended").wait_for(timeout=_ARRIVED_MS)
    page.keyboard.up("Space")
    ended = page.locator(".ended").inner_text()
    _press(page, "Understood")
    return ended


def _begin_anew(page: Page) -> None:
    """Whatever a crowded machine has ended is acknowledged, and the guide stated empty."""
    if page.locator("main[data-state=safe_hold]").is_visible():
        _press(page, "empty")
        _press(page, "Acknowledge")
        page.locator("main:not([data-state=safe_hold])").wait_for()
    if page.locator(".banner.is-refusal").is_visible():
        _press(page, "Close")
    _press(page, "State a fact")
    _press(page, "The guide is empty")
    page.locator(".guide.is-empty").wait_for()


def test_the_arm_is_moved_by_keys(page, stage, case):
    goal = np.array(case.status()["arm"]["base_from_tcp"])
    goal[1, 3] += _STEP_MM
    for _ in range(_TRIES):
        _begin_anew(page)
        _enter_goal(page, goal)
        if _approve(page, stage.people["surgeon"].pin) and ": arrived" in _hold(page):
            return
    pytest.fail("the arm did not arrive")

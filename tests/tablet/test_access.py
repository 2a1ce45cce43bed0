"""Who can use the tablet: screen readers and keyboards by axe's rules, gloves by the size of what they touch."""

from collections.abc import Callable

import pytest
from axe_playwright_python.sync_playwright import Axe
from playwright.sync_api import Page

from service.auth.permissions import Role
from tests.service.conftest import PIN
from tests.tablet.quiet_room import QuietRoom
from tests.tablet.tablet import Tablet

_LEAST_TOUCH_PX = 64.0  # gloves
_ROUNDED_PX = 0.5
# A place, and words that are shown once its screen is whole.
_PLACES = {
    "": "Earlier cases",
    "#new": "Planned paths",
    "#devices": "Device files",
    "#case/{case}": "Open the record",
    "#review/{case}": "Case closed",
}
_SIZES = """Array.from(document.querySelectorAll('button, input:not(.file)'), (one) => {
    const { width, height } = one.getBoundingClientRect();
    return [one.innerText || one.className, width, height];
})"""
_TAKES_A_FINGER = """(button) => {
    const { left, right, top, bottom } = button.getBoundingClientRect();
    return button.contains(document.elementFromPoint((left + right) / 2, (top + bottom) / 2));
}"""


@pytest.fixture
def at(room: QuietRoom) -> Callable[[str], Tablet]:
    """The surgeon's tablet at some place."""

    def go(place: str) -> Tablet:
        tablet = room.tablet_of(Role.SURGEON, place.format(case=room.case_id))
        tablet.page.locator("#app").get_by_text(_PLACES[place]).first.wait_for()
        tablet.page.wait_for_function("() => document.getAnimations().length === 0")
        return tablet

    return go


def _violations(page: Page) -> list[tuple[str, str]]:
    return [(one["id"], one["nodes"][0]["html"]) for one in Axe().run(page).response["violations"]]


# axe looks at them in make test too, with more on them: test_room_screens.py.
_LOOKED_AT = {"#devices", "#review/{case}"}


@pytest.mark.parametrize(
    "place", [pytest.param(one, marks=[pytest.mark.lengthy] if one in _LOOKED_AT else []) for one in _PLACES]
)
def test_axe_finds_nothing_and_a_glove_hits_whatever_is_to_be_touched(at, place):
    page = at(place).page
    assert _violations(page) == []
    sizes = page.evaluate(_SIZES)
    assert [one for one in sizes if 0.0 < min(one[1:]) < _LEAST_TOUCH_PX - _ROUNDED_PX] == []


def test_axe_finds_nothing_at_the_door_and_above_a_sheet(room, at):
    door = room.open_at(room.running.url)
    door.page.goto(door.url)
    door.page.get_by_label("Name").wait_for()
    assert _violations(door.page) == []
    tablet = at("#case/{case}")
    tablet.hand.tap("More", exact=True)
    tablet.hand.tap("Write a note")
    tablet.page.locator(".sheet").wait_for()
    assert _violations(tablet.page) == []


def test_the_keyboard_reaches_sign_in_and_stop(room):
    tablet = room.open_at(room.running.url, has_touch=False)
    page = tablet.page
    page.goto(tablet.url)
    page.get_by_label("Name").fill(Role.SURGEON.value)
    page.locator(".pad").focus()
    page.keyboard.type(PIN)
    page.keyboard.press("Enter")
    page.get_by_role("heading", name="Cases, ").wait_for()
    for _ in range(20):
        page.keyboard.press("Tab")
        if page.evaluate("document.activeElement.className") == "stop":
            break
    page.keyboard.press("Enter")
    page.locator(".stop small:not(:empty)").wait_for()


def test_the_second_tap_of_a_double_tap_presses_no_button_that_came_under_it(at):
    page = at("#case/{case}").page
    new = page.evaluate_handle(
        "() => { const button = document.querySelector('.is-primary'), again = button.cloneNode(true);"
        " button.replaceWith(again); return again; }"
    )
    assert not page.evaluate(_TAKES_A_FINGER, new)
    page.wait_for_function(_TAKES_A_FINGER, arg=new)

"""What is next, and stop, are on the first screen of a small tablet, in both languages, with no word cut off."""

from collections.abc import Callable
from dataclasses import dataclass, field

import pytest
from playwright.sync_api import Page

from benchmarks.recorded_cases import Results
from service.auth.permissions import Role
from tests.service.conftest import PIN
from tests.tablet.picture import take_picture
from tests.tablet.tablet import IS_ON_TOP, Tablet
from workflow.states import State

pytestmark = pytest.mark.lengthy

_SCREENS = [(1280, 800), (1024, 768)]
_LANGUAGES = ["de-DE", "en-GB"]
_PRIMARY = ".button.is-primary:not([disabled])"
_LIFE_S = 30.0
_DETECTABLE = {"rotation_deg": 0.25, "across_mm": 1.2, "along_mm": 12.5}
# What comes next in each state; a waiting screen says for what.
_NEXT = {
    State.CASE_OPEN: _PRIMARY,
    State.CARM_POSITIONED: _PRIMARY,
    State.IMAGE_ACQUIRED: ".waiting",
    State.REGISTERED: ".doing .hint",
    State.TARGET_CHOSEN: _PRIMARY,
    State.MOVING: ".waiting",
    State.MOVED: _PRIMARY,
    State.VERIFIED: _PRIMARY,
    State.OFF_TARGET: _PRIMARY,
    State.INSERTING: _PRIMARY,
    State.SLEEVE_INSERTED: _PRIMARY,
    State.SAFE_HOLD: ".doing .chips",
    State.CLOSED: _PRIMARY,
    State.ABORTED: _PRIMARY,
}
# What is decided in a state rests on this, down to the last figure.
_RESTS_ON = dict.fromkeys(
    (State.VERIFIED, State.OFF_TARGET), (".verdict", ".doing .figures ~ .figures .row:last-child", ".others button")
)
_PLACES = {
    "": (Role.SURGEON, _PRIMARY),
    "#new": (Role.SURGEON, ".is-bar-next"),
    "#devices": (Role.ENGINEER, ".upload"),
    "#check": (Role.ENGINEER, _PRIMARY),
    "#review/{case}": (Role.AUDITOR, ".timeline"),
    "#images/{case}": (Role.AUDITOR, ".timeline"),
}
_AT_REST = "() => document.getAnimations().every((one) => one.effect.getTiming().iterations === Infinity)"
# Each line of text that leaves the screen, its button, or what cuts it off; what scrolls downwards cuts nothing off.
_CUT_OFF = """() => {
    const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT), found = [];
    const isBeside = (line, box) => line.left < box.left - 1 || line.right > box.right + 1;
    const isBelow = (line, box) => line.top < box.top - 1 || line.bottom > box.bottom + 1;
    while (walker.nextNode()) {
        const text = walker.currentNode, range = document.createRange();
        const isShown = text.parentElement.checkVisibility() && !text.parentElement.closest('option');
        if (!text.data.trim() || !isShown) continue;
        range.selectNodeContents(text);
        for (const line of range.getClientRects()) {
            let mayScroll = false;
            for (let around = text.parentElement; around; around = around.parentElement) {
                const { overflowX, overflowY, textOverflow } = getComputedStyle(around);
                const isButton = around.tagName === 'BUTTON', box = around.getBoundingClientRect();
                if (textOverflow === 'ellipsis') break;
                const cutsBeside = isButton || overflowX !== 'visible';
                const cutsBelow = (isButton || overflowY === 'hidden') && !mayScroll;
                if ((cutsBeside && isBeside(line, box)) || (cutsBelow && isBelow(line, box)))
                    found.push([text.data, around.className]);
                mayScroll ||= ['auto', 'scroll'].includes(overflowY);
            }
        }
    }
    return found;
}"""
_MORE_UNTOLD = """() => {
    const doing = document.querySelector('.doing'), told = document.querySelector('.below');
    if (!doing || doing.scrollHeight - doing.clientHeight - doing.scrollTop <= 8) return false;
    if (!told || getComputedStyle(told).visibility !== 'visible') return true;
    const { top, height } = told.getBoundingClientRect();
    return height === 0 || top < doing.getBoundingClientRect().bottom;
}"""
# Each line of text in the half where things are done that something lies over, though it is not scrolled away.
_COVERED = """() => {
    const doing = document.querySelector('.doing');
    if (!doing || document.querySelector('.sheet-back, .drawer')) return [];
    const walker = document.createTreeWalker(doing, NodeFilter.SHOW_TEXT), found = [];
    const edge = doing.getBoundingClientRect();
    while (walker.nextNode()) {
        const text = walker.currentNode, range = document.createRange(), part = text.parentElement;
        if (!text.data.trim() || !part.checkVisibility()) continue;
        range.selectNodeContents(text);
        for (const line of range.getClientRects()) {
            const x = (line.left + line.right) / 2, y = line.bottom - 2;
            if (y <= edge.top || y >= edge.bottom) continue;
            const top = document.elementFromPoint(x, y);
            if (!top || !(part.contains(top) || top.contains(part))) found.push(text.data);
        }
    }
    return found;
}"""
_IN_SIGHT = """(element) => {
    const { left, right, top, bottom } = element.getBoundingClientRect();
    const places = [[left + 9, top + 9], [right - 9, top + 9], [left + 9, bottom - 9], [right - 9, bottom - 9]];
    const half = element.closest('.doing')?.getBoundingClientRect();
    if (half && (top < half.top - 1 || bottom > half.bottom + 1)) return false;
    return left >= 0 && top >= 0 && right <= innerWidth && bottom <= innerHeight
        && (!element.matches('button, p, .row')
            || places.every(([x, y]) => element.contains(document.elementFromPoint(x, y))));
}"""


@dataclass
class Looks:
    """What was found wrong with the screens that were looked at."""

    tablet: Tablet
    name: str
    faults: list[str] = field(default_factory=list)

    def look(self, screen: str, next_action: str, *told: str) -> None:
        """At the screen that is shown, once what comes next is there; what must be told lies whole in sight."""
        page = self.tablet.page
        page.locator(next_action).first.wait_for()
        page.wait_for_function(_AT_REST)
        take_picture(page, f"{self.name}_{screen}")
        self.faults += [f"{screen}: {text!r} leaves {what!r}" for text, what in page.evaluate(_CUT_OFF)]
        for what in (next_action, ".stop", *told):
            parts = page.locator(what).all() if what in told else [page.locator(what).first]
            if not parts or not all(part.evaluate(_IN_SIGHT) for part in parts):
                self.faults.append(f"{screen}: {what} is not whole in sight")
        self.faults += [f"{screen}: something lies over {text!r}" for text in page.evaluate(_COVERED)]
        if page.evaluate(_MORE_UNTOLD):
            self.faults.append(f"{screen}: nothing says that there is more below, or it covers something")
        if not page.evaluate(IS_ON_TOP, ".stop"):
            self.faults.append(f"{screen}: something lies over stop")


@pytest.fixture(params=_SCREENS, ids=lambda size: f"{size[0]}x{size[1]}")
def size(request: pytest.FixtureRequest) -> dict[str, int]:
    return dict(zip(("width", "height"), request.param, strict=True))


@pytest.fixture(params=_LANGUAGES)
def language(request: pytest.FixtureRequest) -> str:
    return str(request.param)


@pytest.fixture
def at(allowed_at, size, language) -> Callable[[State], Looks]:
    """Somebody who looks at a screen of this size and language, in some state of the case."""

    def go(state: State) -> Looks:
        tablet = allowed_at(state, viewport=size, locale=language)
        tablet.is_at(state)
        return Looks(tablet, f"{language[:2]}_{size['width']}")

    return go


def test_what_is_next_is_in_sight_in_every_state(procedure, at):
    looks = at(State.CASE_OPEN)
    for state, next_action in _NEXT.items():
        procedure.put(state, held_for="program_started" if state is State.SAFE_HOLD else None)
        looks.tablet.is_at(state)
        if state in (State.REGISTERED, State.TARGET_CHOSEN, State.VERIFIED):
            looks.tablet.page.locator(".stage-parts").wait_for()
        looks.look(state, next_action, *_RESTS_ON.get(state, ()))
    assert looks.faults == []


def test_a_point_can_be_confirmed_without_scrolling(at):
    looks = at(State.REGISTERED)
    looks.tablet.page.locator(".stage-parts").wait_for()
    looks.tablet.settle()
    looks.tablet.pick((500.0, 500.0))
    looks.look("picked", _PRIMARY)
    assert looks.faults == []


def test_a_motion_is_entered_planned_approved_and_held_without_scrolling(at, results):
    looks = at(State.CARM_POSITIONED)
    page, hand = looks.tablet.page, looks.tablet.hand
    _answer_motions(page, results)
    for tab in range(3):
        _open_motions(looks, tab)
        for number in range(page.locator("[data-field]").count()):
            hand.tap(page.locator("[data-field]").nth(number))
            looks.look("number", ".sheet .is-enter")
            hand.enter("1207")
        looks.look(f"motion_{tab}", ".bringing .is-primary, .nudges")
        page.reload()
    _open_motions(looks, 2)
    hand.tap(page.locator(".bringing .is-primary"))
    looks.look("plan", ".doing .actions > .is-primary", ".doing .note")  # what would be seen, before the approval
    hand.tap(page.locator(".doing .actions > .is-primary"))
    looks.look("pin", ".sheet .is-enter")
    hand.enter(PIN)
    looks.look("hold", ".hold", ".permit-left", ".permit button")
    assert looks.faults == []


def _open_motions(looks: Looks, tab: int) -> None:
    looks.tablet.hand.tap(looks.tablet.page.locator(".bringing > button"))
    looks.tablet.hand.tap(looks.tablet.page.locator(".bringing .tab").nth(tab))


def _answer_motions(page: Page, results: Results) -> None:
    """The quiet room has no arm: what a service with one would answer to a plan, of a target's figures, and a PIN."""
    planned = {"case_id": "", "made": {"plan": "p"}, "detail": dict(results.plan) | {"detectable_motion": _DETECTABLE}}
    approved = {"case_id": "", "made": {"permit": "p"}, "detail": {"life_s": _LIFE_S}}
    page.route(
        "**/plan-requested", lambda route: route.fulfill(json=planned | {"case_id": _case_in(route.request.url)})
    )
    page.route("**/move-approved", lambda route: route.fulfill(json=approved))


def _case_in(url: str) -> str:
    return url.split("/cases/")[1].split("/")[0]


def test_every_sheet_ends_above_stop(at):
    looks = at(State.VERIFIED)
    hand, buttons = looks.tablet.hand, looks.tablet.page.locator(".bar [aria-expanded]")
    for number, drawer in enumerate(("facts", "more")):
        hand.tap(buttons.nth(number))
        looks.look(drawer, ".drawer .facts")
        hand.tap(buttons.nth(number))
    hand.tap(looks.tablet.page.locator(".bar .icon-pause"))
    looks.look("pause", ".sheet .reasons")
    assert looks.faults == []


@pytest.mark.parametrize("place", _PLACES)
def test_what_is_next_is_in_sight_at_every_place(room, size, language, place):
    role, next_action = _PLACES[place]
    tablet = room.tablet_of(role, place.format(case=room.case_id), viewport=size, locale=language)
    looks = Looks(tablet, f"{language[:2]}_{size['width']}")
    looks.look(place.split("/")[0].strip("#") or "cases", next_action)
    if place.startswith("#review"):
        tablet.hand.tap(tablet.page.locator(".entry-line.is-images button").last)
        tablet.page.locator(".compare canvas").first.wait_for()
        looks.look("record", ".detail-head")
    assert looks.faults == []


def test_what_is_next_is_in_sight_at_the_door(room, size, language):
    tablet = room.open_at(room.running.url, viewport=size, locale=language)
    tablet.page.goto(tablet.url)
    looks = Looks(tablet, f"{language[:2]}_{size['width']}")
    looks.look("door", ".pad .is-enter")
    assert looks.faults == []

"""What the page asks: one reading for many events, a motion only of entered numbers, a PIN with the focus kept."""

from dataclasses import dataclass, field

import pytest
from playwright.sync_api import APIResponse, Page, Route

from tests.tablet.conftest import STATUS
from tests.tablet.quiet_room import answer_as_if_all_were_allowed
from workflow.states import State

_EVENTS = 20
_LOOK_EVERY_MS = 20
_HAS_HEARD = """state => import('/js/case/live.js').then(({ events }) => events.value.at(-1)?.state === state)"""
_POSE = {"x": 510.0, "y": -20.5, "z": 305.0, "rx": 0.0, "ry": -3.0, "rz": 90.0}
_FOCUSED_IN = """() =>
    ['.sheet', '.stop', '.emergency', 'button, a, input'].find((one) => document.activeElement.closest(one)) ?? ''
"""
_MORE_TABS_THAN_PLACES = 60


@dataclass
class Readings:
    """Readings of the status that the page has asked for: what the service said at once, answered when let go."""

    page: Page
    asked: list[tuple[Route, APIResponse]] = field(default_factory=list)

    def take(self, route: Route) -> None:
        self.asked.append((route, route.fetch()))

    def wait_for(self, count: int) -> None:
        while len(self.asked) < count:
            self.page.wait_for_timeout(_LOOK_EVERY_MS)

    def let_go(self) -> None:
        """The newest of them."""
        route, answer = self.asked[-1]
        answer_as_if_all_were_allowed(route, answer)


def test_many_events_cost_one_reading_and_nothing_is_asked_for_before_it_is_shown(procedure, allowed_at):
    tablet = allowed_at(State.MOVED)
    primary = tablet.page.locator(".button.is-primary")
    tablet.page.locator(".button.is-primary:not([disabled])").wait_for()
    readings = Readings(tablet.page)
    tablet.page.route(STATUS, readings.take)
    readings.wait_for(1)
    for _ in range(_EVENTS):
        procedure.put(State.MOVED)
    procedure.put(State.VERIFIED)
    tablet.page.wait_for_function(_HAS_HEARD, arg=State.VERIFIED.value)
    assert primary.is_disabled()
    assert len(readings.asked) == 1
    readings.let_go()
    readings.wait_for(2)
    tablet.is_at(State.MOVED)
    assert primary.is_disabled()
    assert len(readings.asked) == 2
    readings.let_go()
    tablet.is_at(State.VERIFIED)


def test_an_approach_goes_where_six_entered_numbers_say_and_nowhere_else(allowed_at):
    tablet = allowed_at(State.CASE_OPEN)
    page = tablet.page
    tablet.hand.tap("Move the arm nearer or away")
    plan = page.get_by_role("button", name="Plan the motion")
    left = list(_POSE)
    for name, value in _POSE.items():
        page.get_by_text(f"Still to be entered: {', '.join(left)}.").wait_for()
        assert plan.count() == 0
        page.locator(f"[data-field={name}]").press("Enter")
        page.locator(".pad").press_sequentially(str(value))
        page.keyboard.press("Enter")
        left.remove(name)
    with page.expect_request("**/plan-requested") as asked:
        tablet.hand.tap(plan)
    *translation_mm, rx, ry, rz = _POSE.values()
    goal = {"translation_mm": translation_mm, "rotation_vector_deg": [rx, ry, rz]}
    assert asked.value.post_data_json == {"kind": "approach", "base_from_goal": goal}


def test_the_keyboard_stays_in_a_question_with_stop_and_the_title_follows_the_language(allowed_at):
    tablet = allowed_at(State.VERIFIED)
    page = tablet.page
    tablet.press("Lock the arm and insert")
    page.get_by_role("heading", name="Your PIN starts the insertion").wait_for()
    for key in ("Tab", "Shift+Tab"):
        reached = set()
        for _ in range(_MORE_TABS_THAN_PLACES):
            page.keyboard.press(key)
            reached.add(page.evaluate(_FOCUSED_IN))
        assert ".sheet" in reached
        assert reached <= {".sheet", ".stop", ".emergency", ""}
    assert ".stop" in reached
    page.evaluate("import('/js/words.js').then(({ speak }) => speak('de'))")
    page.get_by_role("heading", name="Ihre PIN beginnt die Einführung").wait_for()


def test_what_is_refused_before_it_came_to_its_interlocks_shows_none_of_them(allowed_at):
    tablet = allowed_at(State.CASE_OPEN)
    page = tablet.page
    failed = {"code": "at_rest", "hazard": "H04", "message": "m", "passed": False, "measured": None, "limit": None}
    told = {
        "code": "missing",
        "trigger": "carm_position_confirmed",
        "verdicts": [failed],
        "detail": "",
        "what_to_do": "",
    }
    page.route("**/carm-position-confirmed", lambda route: route.fulfill(status=409, json=told))
    page.locator(".button.is-primary:not([disabled])").click()
    banner = page.locator(".banner.is-refusal")
    banner.wait_for()
    assert banner.locator("li").count() == 0
    assert "Not now" not in banner.inner_text()


_LEFT_AMID_A_COMMAND = """async () => {
    const [{ send, tell, refusal }, { follow }] =
        await Promise.all([import('/js/case/commands.js'), import('/js/case/live.js')]);
    const fact = tell('note', { text: 'first' });
    const request = send('carm_position_confirmed');
    const leave = follow('another');
    await Promise.all([fact, request]);
    leave();
    return refusal.value.code;
}"""


def test_a_request_that_had_to_wait_is_not_sent_for_a_case_that_was_opened_meanwhile(allowed_at):
    tablet = allowed_at(State.CASE_OPEN)
    page, sent = tablet.page, []
    page.on("request", lambda request: request.method == "POST" and sent.append(request.url.rsplit("/", 1)[-1]))
    page.locator(".button.is-primary:not([disabled])").wait_for()
    page.route("**/cases/another/**", lambda route: route.abort())
    assert page.evaluate(_LEFT_AMID_A_COMMAND) == "case_left"
    assert sent == ["note"]


_SERVICE_AHEAD_OF_THE_TABLET = """async (wrong_by_ms) => {
    const { serviceNowMs, get } = await import('/js/api.js');
    const now = Date.now;
    Date.now = () => now() + wrong_by_ms;
    await get('/cases');
    return serviceNowMs() - now();
}"""


@pytest.mark.parametrize("wrong_by_ms", [-3_600_000, 0, 3_600_000])
def test_a_tablet_whose_clock_is_wrong_counts_by_the_service_s(allowed_at, wrong_by_ms):
    page = allowed_at(State.CASE_OPEN).page
    assert -1000.0 <= page.evaluate(_SERVICE_AHEAD_OF_THE_TABLET, wrong_by_ms) <= 1500.0


def test_what_is_just_beyond_its_limit_does_not_read_as_at_it(allowed_at):
    told = (
        "() => import('/js/words.js').then(({ againstLimit }) => [againstLimit(100.4, 100, 'mm'), againstLimit(5, 1)])"
    )
    close, apart = allowed_at(State.CASE_OPEN).page.evaluate(told)
    assert close == "measured 100.400000 mm, limit 100.000000 mm"
    assert apart == "measured 5.000, limit 1.000"

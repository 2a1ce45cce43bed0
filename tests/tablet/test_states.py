"""What a tablet offers in every state of a case, seen at a recorded one that is put into them."""

import pytest

from service.auth.permissions import Role
from service.conductor.unusable import what_to_do
from service.errors import ErrorCode
from tests.service.conftest import PIN
from tests.tablet.conftest import STATUS
from tests.tablet.tablet import IS_ON_TOP
from workflow.states import GuideState, State

_FACTS = 9
# An arm that moves, or was stopped, is still at the step that it set out from: of those before it in the test.
_STEP = {
    State.CASE_OPEN: 1,
    State.CARM_POSITIONED: 2,
    State.IMAGE_ACQUIRED: 3,
    State.REGISTERED: 4,
    State.TARGET_CHOSEN: 5,
    State.MOVING: 5,
    State.MOVED: 6,
    State.VERIFIED: 7,
    State.OFF_TARGET: 7,
    State.INSERTING: 8,
    State.SLEEVE_INSERTED: 8,
    State.SAFE_HOLD: 8,
    State.CLOSED: 9,
    State.ABORTED: 9,
}
_LONGER_THAN_THE_LOCK = "00:20:00"
_LOOKED_MS = 2500  # more than two looks of the page at its clock
_ADDED_UP = "([error, bound]) => import('/js/screens/verified.js').then(({ addedUp }) => addedUp(error, bound))"
_A_FACT_AND_AT_ONCE_A_REQUEST = """() => import('/js/case/commands.js').then(({ tell, send }) =>
    Promise.all([tell('guide_state_stated', { guide: 'wire' }), send('hold_requested', { reason: 'test' })]))"""


@pytest.mark.parametrize(
    "states",
    [
        (State.TARGET_CHOSEN, State.MOVING, State.SLEEVE_INSERTED),
        pytest.param(tuple(State), marks=pytest.mark.lengthy),
    ],
)
def test_the_step_facts_stop_and_the_way_to_the_pendant_are_always_there(procedure, at_the_case, states):
    procedure.put(states[0], held_for="stop")
    tablet = at_the_case()
    for state in states:
        procedure.put(state)
        tablet.is_at(state)
        tablet.page.locator(f".step:nth-child({_STEP[state]})[aria-current=step]").wait_for()
        assert tablet.page.locator("[aria-current=step]").count() == 1
        for within_reach in (".stop", ".emergency", ".bar [aria-expanded]"):
            assert tablet.page.evaluate(IS_ON_TOP, within_reach), state
        tablet.hand.tap("State a fact")
        assert tablet.page.locator(".fact").count() == _FACTS
        tablet.hand.tap("State a fact")


def test_an_untouched_tablet_locks_and_never_while_the_arm_moves(procedure, at_the_case):
    procedure.put(State.MOVING)
    tablet = at_the_case()
    tablet.page.clock.install()
    tablet.page.reload()
    tablet.is_at(State.MOVING)
    tablet.page.clock.fast_forward(_LONGER_THAN_THE_LOCK)
    tablet.page.clock.run_for(_LOOKED_MS)
    assert not [url for url in tablet.asked if url.endswith("/session/lock")]
    procedure.put(State.MOVED)
    tablet.is_at(State.MOVED)
    tablet.page.clock.fast_forward(_LONGER_THAN_THE_LOCK)
    tablet.page.get_by_role("heading", name="Locked").wait_for()
    tablet.hand.enter(PIN)
    tablet.is_at(State.MOVED)


def test_a_request_right_behind_a_fact_is_made_on_what_the_fact_left(room, open_case):
    tablet = room.tablet_of(Role.SURGEON)
    tablet.press("Enter the case")
    tablet.is_at(State.CASE_OPEN)
    tablet.page.evaluate(_A_FACT_AND_AT_ONCE_A_REQUEST)
    tablet.is_at(State.SAFE_HOLD)


def test_a_point_is_picked_and_moved_by_keys(procedure, at_the_case):
    procedure.put(State.REGISTERED, target=None, verification=None)
    tablet = at_the_case()
    tablet.page.locator(".stage-parts").wait_for()
    tablet.page.locator(".stage-image").focus()
    for key in ("Enter", "+", "+", "ArrowLeft", "ArrowUp"):
        tablet.page.keyboard.press(key)
    tablet.page.locator("[data-understood]").wait_for()
    picked_px = tablet.picked_px()
    assert tablet.understood_px() == pytest.approx(picked_px, abs=0.5)
    tablet.page.get_by_role("button", name="Right by a quarter pixel").press("Enter")
    tablet.page.wait_for_function(
        "before => document.querySelector('[data-picked]').dataset.picked !== before",
        arg=f"{picked_px[0]},{picked_px[1]}",
    )
    assert tablet.picked_px() == pytest.approx((picked_px[0] + 0.25, picked_px[1]), abs=1e-6)


@pytest.mark.hazard("H33")
def test_evaluations_that_disagree_again_are_told_with_the_way_on_until_there_is_another_registration(
    procedure, at_the_case
):
    code = ErrorCode.EVALUATIONS_DISAGREE_AGAIN
    reason = {"code": code, "message": "disagree", "measured": 0.091, "limit": 0.06, "unit": "mm"}
    told = {"reason": reason, "what_to_do": what_to_do(code), "leads_onwards": ["target_withdrawn"]}
    procedure.tell("verification_refused", told)
    procedure.put(State.MOVED)
    tablet = at_the_case()
    refusal = tablet.page.locator(".refusing", has_text="The image cannot be used")
    for state in (State.MOVED, State.REGISTERED):
        procedure.put(state)
        tablet.is_at(state)
        words = refusal.inner_text()
        assert "measured 0.091 mm, limit 0.060 mm" in words
        assert what_to_do(code) in words
    procedure.tell("registration_completed", {})
    refusal.wait_for(state="detached")


@pytest.mark.parametrize(
    ("left", "heading"), [("open", "Choose the target"), ("placed", "Every planned target is done")]
)
def test_where_every_planned_target_is_done_closing_the_case_is_offered(procedure, at_the_case, left, heading):
    def answer_with_two_targets(route):
        answer = route.fetch()
        told = answer.json()
        told["targets"] = {"L3-left": "placed", "L3-right": left}
        told["allowed"]["case_closed"] |= {"allowed": True, "permitted": True, "reasons": []}
        route.fulfill(response=answer, json=told)

    procedure.put(State.REGISTERED, target=None, verification=None)
    tablet = at_the_case()
    tablet.page.route(STATUS, answer_with_two_targets)
    tablet.page.reload()
    tablet.is_at(State.REGISTERED)
    tablet.page.get_by_role("heading", name=heading).wait_for()
    closing = tablet.page.locator(".doing").get_by_role("button", name="Close the case")
    assert closing.count() == (left != "open")
    if left != "open":
        tablet.hand.tap(closing)
        tablet.page.get_by_text("Your PIN signs the case").wait_for()
        tablet.hand.tap("Cancel")
    tablet.page.unroute_all(behavior="ignoreErrors")


@pytest.mark.hazard("H35")
def test_a_hold_is_not_acknowledged_before_somebody_says_what_is_in_the_guide(procedure, allowed_at):
    tablet = allowed_at(State.MOVED)
    procedure.put(State.SAFE_HOLD, held_for="stop", guide=GuideState.EMPTY)
    tablet.is_at(State.SAFE_HOLD)
    tablet.page.locator(".guide.is-empty").wait_for()
    chips = tablet.page.locator(".doing .chip")
    assert tablet.page.locator(".doing .chip[aria-pressed=true]").count() == 0
    assert tablet.page.get_by_role("button", name="Acknowledge").count() == 0
    tablet.hand.tap(chips.filter(has_text="empty"))
    tablet.page.get_by_role("button", name="Acknowledge").wait_for()


@pytest.mark.parametrize(
    ("error", "bound", "shown"),
    [
        (0.01044, 0.04844, ["0.059", "0.010", "0.049"]),
        (1.3984, 0.1194, ["1.518", "1.398", "0.120"]),
        (0.1, 0.2, ["0.300", "0.100", "0.200"]),
        (0.0107, 0.0482, ["0.059", "0.011", "0.048"]),
    ],
)
def test_an_error_its_bound_and_their_sum_add_up_as_they_are_shown(procedure, at_the_case, error, bound, shown):
    procedure.put(State.VERIFIED)
    assert at_the_case().page.evaluate(_ADDED_UP, [error, bound]) == shown

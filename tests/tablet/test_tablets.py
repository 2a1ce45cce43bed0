"""Tablets beside one another, and stop above everything."""

import pytest

from service.auth.permissions import Role
from tests.tablet.quiet_room import QuietRoom
from tests.tablet.tablet import IS_ON_TOP, Tablet


@pytest.fixture
def enter(room: QuietRoom, open_case: str):
    """A tablet of somebody, in the open case."""

    def of(role: Role) -> Tablet:
        tablet = room.tablet_of(role)
        tablet.press("Enter the case")
        tablet.is_at("case_open")
        return tablet

    return of


@pytest.mark.lengthy
def test_control_goes_from_one_tablet_to_the_other_and_all_see_it(enter):
    first, second, observer = enter(Role.SURGEON), enter(Role.SURGEON), enter(Role.OPERATOR)
    for tablet, other in ((first, second), (second, first)):
        tablet.take_control()
        for seeing in (other, observer):
            seeing.page.locator(".control:not(.is-yours)", has_text="Control: surgeon").wait_for()


def test_what_one_states_and_releases_the_others_see_and_a_role_is_refused_in_words(enter):
    surgeon, operator = enter(Role.SURGEON), enter(Role.OPERATOR)
    operator.state_fact("A wire is in the guide")
    for seeing in (surgeon, operator):
        seeing.page.locator(".guide.is-wire").wait_for()
    operator.hand.tap("Move the arm nearer or away")
    operator.page.get_by_text("not for your role").first.wait_for()
    operator.hand.tap("Emergency access")
    surgeon.is_at("safe_hold")


def test_stop_is_in_reach_above_every_sheet_and_is_heard_from_a_locked_tablet(enter):
    surgeon, observer = enter(Role.SURGEON), enter(Role.OPERATOR)
    surgeon.hand.tap("Pause")
    surgeon.page.locator(".sheet").wait_for()
    assert surgeon.page.evaluate(IS_ON_TOP, ".stop")
    surgeon.hand.tap("Cancel")
    surgeon.hand.tap("State a fact")
    assert surgeon.page.evaluate(IS_ON_TOP, ".stop")
    surgeon.hand.tap("Lock")
    surgeon.page.get_by_role("heading", name="Locked").wait_for()
    assert surgeon.page.evaluate(IS_ON_TOP, ".stop")
    surgeon.hand.tap("STOP")
    observer.is_at("safe_hold")

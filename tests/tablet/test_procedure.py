"""A whole procedure by touch alone, and a picture of each of its screens."""

from collections.abc import Callable
from functools import partial

import pytest

from coaxial_client import Case
from simulator.demo.stage import Stage
from tests.tablet.conftest import PEDICLE
from tests.tablet.picture import take_picture
from tests.tablet.tablet import Tablet
from tests.tablet.walk import Walk


@pytest.fixture
def look(surgeon: Tablet) -> Callable[[str], None]:
    """Take a picture of the screen."""
    return partial(take_picture, surgeon.page)


@pytest.fixture
def walk(stage: Stage, surgeon: Tablet, case: Case, look: Callable[[str], None]) -> Walk:
    return Walk(surgeon, case, stage.door, stage.people["surgeon"].pin, look)


@pytest.mark.hazard("H08")
@pytest.mark.lengthy
@pytest.mark.timeout(420)  # half a minute on a quiet machine; a crowded one loses the hold again and again
def test_a_whole_procedure_goes_by_touch_alone(walk, surgeon):
    walk.begin()
    walk.turn_carm(PEDICLE)
    walk.look("carm_positioned")
    walk.bring_guide_in(PEDICLE)
    walk.image("Ask for an exposure", "registered")
    walk.choose(walk.door.pixel_of(PEDICLE))
    _onto_target(walk, surgeon)
    walk.look("verified")
    walk.insert()
    walk.retreat()
    walk.close()
    walk.look("closed")
    surgeon.press("Open the record")
    surgeon.hand.tap("Images")
    surgeon.hand.tap(surgeon.page.locator(".entry-line button", has_text="An image arrived"))
    surgeon.page.locator(".review-seen canvas").first.wait_for()
    walk.look("review")
    true = walk.door.true_error(PEDICLE)
    assert walk.case.status()["targets"] == {PEDICLE: "placed"}
    assert true is not None


def _onto_target(walk: Walk, surgeon: Tablet) -> None:
    """Move and verify, and once more where the limits ask for it."""
    for take in ("", "_again", "_once_more"):
        surgeon.is_at("target_chosen")
        walk.look("target_chosen")
        walk.go(lambda: surgeon.press("Plan the motion"), f"_target{take}")
        surgeon.is_at("moved")
        walk.image("Ask for the verifying exposure", "verified", "off_target")
        if surgeon.page.locator("main[data-state=verified]").is_visible():
            return
        walk.look("off_target")
        walk.correct()
    pytest.fail("off target after two corrections")

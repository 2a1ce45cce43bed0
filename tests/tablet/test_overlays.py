"""What is drawn over an image, and two images over one another: each switch does what it says, seen in the pixels."""

import base64
import io
from collections.abc import Callable

import cv2
import numpy as np
import pydicom
import pytest
from playwright.sync_api import Locator, Route

from tests.tablet.tablet import Tablet
from workflow.states import State

pytestmark = pytest.mark.lengthy

_PARTS = ["rings", "line", "fiducials", "balls", "bounds", "path", "targets"]
_ON_THE_PLATE = [[300.0, 300.0], [700.0, 320.0]]
_PNG = """() => document.querySelector('.stage-image canvas').toDataURL('image/png').split(',')[1]"""
_COLOUR = """chip => {
    const probe = document.createElement('i');
    probe.style.color = getComputedStyle(chip).getPropertyValue('--part');
    document.body.append(probe);
    const colour = getComputedStyle(probe).color.match(/[0-9]+/g).map(Number);
    probe.remove();
    return colour;
}"""
_LOOK_EVERY_MS = 50
_PATIENCE_LOOKS = 600
_LIKE = 40.0  # grey levels from a part's colour, all three together: the edge of a line is mixed with what is below
_ROUNDED = 1.5  # grey levels: two roundings and the browser's own


def _canvas(tablet: Tablet) -> np.ndarray:
    """What the page has drawn, (rows, columns, 3) as RGB."""
    png = np.frombuffer(base64.b64decode(tablet.page.evaluate(_PNG)), np.uint8)
    return np.asarray(cv2.cvtColor(cv2.imdecode(png, cv2.IMREAD_COLOR), cv2.COLOR_BGR2RGB), dtype=float)


def _canvas_when(tablet: Tablet, wanted: Callable[[np.ndarray], bool]) -> np.ndarray:
    for _ in range(_PATIENCE_LOOKS):
        if wanted(drawn := _canvas(tablet)):
            return drawn
        tablet.page.wait_for_timeout(_LOOK_EVERY_MS)
    pytest.fail("it is not drawn")


def _with_a_plate(route: Route) -> None:
    """The recorded image was taken without a plate of balls."""
    answer = route.fetch()
    route.fulfill(response=answer, json=answer.json() | {"balls": _ON_THE_PLATE})


def _chips_off(tablet: Tablet) -> list[Locator]:
    chips = tablet.page.locator(".stage-parts .chip").all()
    for chip in chips:
        if chip.get_attribute("aria-pressed") == "true":
            tablet.hand.tap(chip)
    tablet.page.locator(".stage-parts [aria-pressed=true]").first.wait_for(state="detached")
    tablet.settle()
    return chips


def test_each_switch_shows_and_hides_its_part_and_nothing_else(procedure, at_the_case):
    procedure.put(State.TARGET_CHOSEN, verification=None)
    tablet = at_the_case()
    tablet.page.route("**/overlay*", _with_a_plate)
    tablet.page.reload()
    tablet.page.locator(".stage-parts").wait_for()
    chips = _chips_off(tablet)
    assert [(chip.get_attribute("class") or "").split("chip-")[1] for chip in chips] == _PARTS
    bare = _canvas(tablet)
    for chip in chips:
        tablet.hand.tap(chip)
        shown = _canvas_when(tablet, lambda drawn: not np.array_equal(drawn, bare))
        new = shown[np.any(shown != bare, axis=2)]
        assert np.abs(new - chip.evaluate(_COLOUR)).sum(axis=1).min() < _LIKE
        tablet.hand.tap(chip)
        _canvas_when(tablet, lambda drawn: np.array_equal(drawn, bare))


def test_a_blend_goes_from_the_image_before_to_the_one_after(procedure, at_the_case):
    procedure.put(State.VERIFIED)
    tablet = at_the_case()
    tablet.page.locator(".stage-parts").wait_for()
    _chips_off(tablet)
    tablet.hand.tap("Blend")
    tablet.page.locator(".compare.is-blend").wait_for()
    assert tablet.page.locator(".compare canvas").count() == 1
    before, after = (_blended(tablet, share) for share in (0.0, 1.0))
    half = _blended(tablet, 0.5)
    share = float(tablet.page.locator(".slider input").input_value())
    assert 0.3 < share < 0.7
    assert np.abs(half - (before * (1 - share) + after * share)).max() <= _ROUNDED
    assert np.abs(after - before).max() > 100.0
    first, second = _originals(procedure)
    assert _likeness(before, first) > _likeness(before, second)
    assert _likeness(after, second) > _likeness(after, first)
    tablet.hand.tap("Side by side")
    tablet.page.locator(".compare canvas").nth(1).wait_for()


def _blended(tablet: Tablet, share: float) -> np.ndarray:
    """With the slider touched at this share of its way."""
    box = tablet.page.locator(".slider input").bounding_box()
    assert box is not None
    tablet.hand.tap_at((box["x"] + 1 + share * (box["width"] - 2), box["y"] + box["height"] / 2))
    tablet.settle()
    return _canvas(tablet)


def _originals(procedure) -> list[np.ndarray]:
    """The images as they arrived."""
    with procedure.running.client() as client:
        return [
            np.asarray(
                pydicom.dcmread(io.BytesIO(client.get(f"/images/{one['id']}/original").content)).pixel_array,
                dtype=np.float32,
            )
            for one in sorted(client.get(f"/images?case={procedure.case_id}").json(), key=lambda one: one["position"])
        ]


def _likeness(drawn: np.ndarray, original: np.ndarray) -> float:
    """Correlation of what is drawn with an image that lies whole and upright in the middle of the canvas."""
    side = min(drawn.shape[:2])
    top, left = (drawn.shape[0] - side) // 2, (drawn.shape[1] - side) // 2
    seen = drawn[top : top + side, left : left + side, 0].ravel()
    return float(np.corrcoef(seen, cv2.resize(original, (side, side), interpolation=cv2.INTER_AREA).ravel())[0, 1])

"""H08: the pixel under the finger is the one that the service understands, at every zoom, pan, turn and pixel ratio."""

import base64
import io
import math
from collections.abc import Callable, Iterator

import cv2
import numpy as np
import pydicom
import pytest
from playwright.sync_api import Browser

from service.auth.permissions import Role
from tests.tablet.conftest import CHROMIUM
from tests.tablet.quiet_room import QuietRoom
from tests.tablet.tablet import Tablet
from workflow.states import State

_WITHIN_PX = 0.5
_SEEN_WITHIN = 0.5  # device pixels: half of the least that a screen can show
_TAPS = 6
_FEW_TAPS = 2
_HALF = 110  # CSS pixels of the patch that is compared around a point
_AROUND_PX = 15  # half of what the loupe shows, and less
_LOUPE_TIMES = 4.0  # as the loupe says of itself
_PLACED_TO = 1.0 / 16.0  # image pixels: Chromium's drawing (Skia) knows places between two pixels in sixteenths
_BAR = 4.0  # CSS pixels to each side of the cross's lines, with their dark edge
# A new canvas is wider than high; it gets its size as it is drawn.
_LOUPE_IS_DRAWN = "() => [...document.querySelectorAll('canvas.loupe')].some(({ width, height }) => width === height)"
_LOUPE = "document.querySelector('canvas.loupe').toDataURL('image/png').split(',')[1]"


@pytest.fixture
def screen(browser: Browser, ratio: float) -> Iterator[Browser]:
    """A browser whose screen has this pixel ratio itself: where a page only feigns one, Chromium lays out in CSS pixels
    and paints from whole ones, up to half a CSS pixel beside the place that it tells."""
    arguments = ["--no-sandbox", f"--force-device-scale-factor={ratio}", "--window-size=1280,800"]
    chromium = browser.browser_type.launch(executable_path=CHROMIUM, args=arguments)
    yield chromium
    chromium.close()


@pytest.fixture
def at_the_image(at_the_case: Callable[..., Tablet], procedure: QuietRoom) -> Callable[..., Tablet]:
    """A tablet of some pixel ratio, at the image in which the target is picked."""
    procedure.put(State.REGISTERED, target=None, verification=None)

    def open_at(ratio: float | None = None, **differing: object) -> Tablet:
        tablet = at_the_case(**differing if ratio is None else {"device_scale_factor": ratio})
        tablet.is_at("registered")
        tablet.page.locator(".stage-parts").wait_for()  # what comes with the overlay makes the stage smaller
        tablet.settle()
        return tablet

    return open_at


@pytest.fixture
def pixels(at_the_image: Callable[..., Tablet], procedure: QuietRoom) -> np.ndarray:
    """The image as it arrived."""
    with procedure.running.client(Role.OPERATOR) as client:
        status = client.get(f"/cases/{procedure.case_id}/status").json()
        original = client.get(f"/images/{status['chain']['image']}/original").content
    return np.asarray(pydicom.dcmread(io.BytesIO(original)).pixel_array, dtype=np.float32)


def _change_view(tablet: Tablet, random: np.random.Generator) -> None:
    """Zoomed, shifted and turned, by fingers and buttons."""
    tablet.hand.tap("Whole")
    tablet.hand.tap("Turn the view right", times=int(random.integers(0, 12)))
    middle = tablet.hand.middle_of(tablet.page.locator(".stage-image"))
    shift = tuple(float(value) for value in random.uniform(-80.0, 80.0, 2))
    tablet.hand.pinch(middle, float(random.uniform(0.7, 4.0)), shift=(shift[0], shift[1]))
    tablet.settle()


def _points_in_sight(tablet: Tablet, pixels: np.ndarray, random: np.random.Generator) -> Iterator[tuple[float, float]]:
    """Image points well inside both image and stage."""
    box = tablet.page.locator(".stage-image").bounding_box()
    assert box is not None
    rows, columns = pixels.shape
    while True:
        u_px, v_px = float(random.uniform(20, columns - 20)), float(random.uniform(20, rows - 20))
        x, y = tablet.screen_of((u_px, v_px))
        if box["x"] + 20 < x < box["x"] + box["width"] - 20 and box["y"] + 20 < y < box["y"] + box["height"] - 20:
            yield u_px, v_px


@pytest.mark.parametrize(
    ("ratio", "taps"),
    [(2.625, _FEW_TAPS), *(pytest.param(ratio, _TAPS, marks=pytest.mark.lengthy) for ratio in (1.0, 1.5, 2.0, 2.625))],
)
def test_a_tap_is_understood_where_it_was_made(at_the_image, pixels, ratio, taps):
    tablet, random = at_the_image(ratio), np.random.default_rng(int(ratio * 1000))
    for _ in range(taps):
        _change_view(tablet, random)
        wanted = next(_points_in_sight(tablet, pixels, random))
        tablet.pick(wanted)
        assert math.dist(tablet.picked_px(), wanted) <= _WITHIN_PX
        assert math.dist(tablet.understood_px(), wanted) <= _WITHIN_PX


@pytest.mark.lengthy
@pytest.mark.parametrize("ratio", [1.0, 1.5, 2.0, 2.625])
def test_what_is_seen_at_a_place_is_the_pixel_of_that_place(screen, at_the_image, pixels, ratio):
    """The picture on the glass against the image as it arrived, warped by the view in OpenCV."""
    tablet, random = at_the_image(by=screen, viewport=None, no_viewport=True), np.random.default_rng(7)
    assert tablet.page.evaluate("devicePixelRatio") == ratio
    for part in tablet.page.locator(".stage-parts .chip").all():
        if part.get_attribute("aria-pressed") == "true":
            tablet.hand.tap(part)
    for _ in range(3):
        _change_view(tablet, random)
        middle = tablet.hand.middle_of(tablet.page.locator(".stage-image"))
        aside = _shift(_seen(tablet, middle, ratio), _expected(tablet, pixels, middle, ratio))
        assert np.linalg.norm(aside) <= _SEEN_WITHIN


@pytest.mark.lengthy
@pytest.mark.parametrize("ratio", [1.0, 2.625])
def test_the_loupe_shows_the_picked_pixel_in_its_middle(at_the_image, pixels, ratio):
    """Its picture against the image as it arrived, magnified about the picked pixel by OpenCV."""
    tablet, random = at_the_image(ratio), np.random.default_rng(11)
    for _ in range(_FEW_TAPS):
        tablet.hand.tap("Turn the view right", times=2)
        tablet.settle()
        seen_points = _points_in_sight(tablet, pixels, random)
        tablet.hand.put_down([tablet.screen_of(next(one for one in seen_points if _is_by_an_edge(pixels, one)))])
        tablet.page.wait_for_function(_LOUPE_IS_DRAWN)
        seen = _decoded(base64.b64decode(tablet.page.evaluate(_LOUPE)))
        expected = _magnified(tablet, pixels, seen.shape[0], ratio)
        tablet.hand.lift()
        aside = _shift(seen, expected, _beside_the_cross(seen.shape[0], ratio))
        assert np.linalg.norm(aside) <= _SEEN_WITHIN + _PLACED_TO * _magnification(tablet, ratio)


def test_an_arrow_moves_the_point_by_a_quarter_pixel(at_the_image):
    tablet = at_the_image(1.0)
    tablet.hand.tap("Whole")
    tablet.pick((500.0, 500.0))
    before = tablet.picked_px()
    tablet.hand.tap("Right by a quarter pixel")
    tablet.hand.tap("Down by a quarter pixel")
    after = tablet.picked_px()
    assert after == pytest.approx((before[0] + 0.25, before[1] + 0.25), abs=1e-9)


def test_a_second_finger_moves_the_image_and_not_the_point(at_the_image):
    tablet = at_the_image(1.0)
    middle = tablet.hand.middle_of(tablet.page.locator(".stage-image"))
    tablet.pick((500.0, 500.0))
    before = tablet.picked_px()
    tablet.hand.pinch((middle[0] + 50.0, middle[1]), 2.0)
    assert tablet.picked_px() == before


def _corner(middle: tuple[float, float], ratio: float) -> np.ndarray:
    """The patch's first device pixel."""
    return np.floor((np.array(middle) - _HALF) * ratio)


def _decoded(png: bytes) -> np.ndarray:
    return np.asarray(cv2.imdecode(np.frombuffer(png, np.uint8), cv2.IMREAD_GRAYSCALE), dtype=np.float32)


def _seen(tablet: Tablet, middle: tuple[float, float], ratio: float) -> np.ndarray:
    shot = _decoded(tablet.page.screenshot())
    (left, top), side = _corner(middle, ratio).astype(int), round(2 * _HALF * ratio)
    return shot[top : top + side, left : left + side]


def _expected(tablet: Tablet, pixels: np.ndarray, middle: tuple[float, float], ratio: float) -> np.ndarray:
    """Grey levels at the centre of each device pixel of the patch."""
    corners = [(0.0, 0.0), (200.0, 0.0), (0.0, 200.0)]
    on_glass = np.array([tablet.screen_of(corner) for corner in corners])
    # Device pixel k covers CSS (k .. k + 1) / ratio, so its centre is at (k + 0.5) / ratio.
    in_patch = on_glass * ratio - _corner(middle, ratio) - 0.5
    warp = cv2.getAffineTransform(np.float32(corners), np.float32(in_patch))
    side = round(2 * _HALF * ratio)
    return cv2.warpAffine(pixels, warp, (side, side), flags=cv2.INTER_LINEAR)


def _is_by_an_edge(pixels: np.ndarray, point: tuple[float, float]) -> bool:
    """Whether there is something to be seen around a point: as much contrast as in the whole image."""
    u_px, v_px = (round(value) for value in point)
    around = pixels[v_px - _AROUND_PX : v_px + _AROUND_PX, u_px - _AROUND_PX : u_px + _AROUND_PX]
    return bool(around.std() > pixels.std())


def _magnified(tablet: Tablet, pixels: np.ndarray, side: int, ratio: float) -> np.ndarray:
    """Grey levels of the loupe's device pixels, the picked pixel in its middle."""
    _, angle_rad, *_ = tablet.view()
    turn = _magnification(tablet, ratio) * np.array(
        [[math.cos(angle_rad), -math.sin(angle_rad)], [math.sin(angle_rad), math.cos(angle_rad)]]
    )
    # Device pixel k covers k .. k + 1, so the middle of the loupe is at side / 2 - 0.5.
    shift = side / 2 - 0.5 - turn @ np.array(tablet.picked_px())
    return cv2.warpAffine(pixels, np.column_stack([turn, shift]), (side, side), flags=cv2.INTER_LINEAR)


def _magnification(tablet: Tablet, ratio: float) -> float:
    """Device pixels of the loupe to a pixel of the image."""
    scale, *_ = tablet.view()
    return max(scale * _LOUPE_TIMES, _LOUPE_TIMES) * ratio


def _beside_the_cross(side: int, ratio: float) -> np.ndarray:
    """Device pixels of the loupe that its cross leaves free: all but two bars."""
    from_middle = np.abs(np.arange(side) + 0.5 - side / 2) / ratio
    on_bar = from_middle < _BAR
    return np.uint8(~(on_bar[:, None] | on_bar[None, :])) * 255


def _shift(seen: np.ndarray, expected: np.ndarray, mask: np.ndarray | None = None) -> np.ndarray:
    """Device pixels by which the one lies beside the other."""
    moved, until = np.eye(2, 3, dtype=np.float32), (cv2.TERM_CRITERIA_COUNT | cv2.TERM_CRITERIA_EPS, 200, 1e-6)
    likeness, moved = cv2.findTransformECC(
        _detail(expected), _detail(seen), moved, cv2.MOTION_TRANSLATION, until, mask, 5
    )
    assert likeness > 0.5, "the two pictures are not of the same place"
    return np.asarray(moved[:, 2], dtype=np.float64)


def _detail(patch: np.ndarray) -> np.ndarray:
    """What is sharp in it, in its own units: the window's contrast does not matter."""
    detail = patch - cv2.GaussianBlur(patch, (0, 0), 12.0)
    return np.float32(detail / max(float(detail.std()), 1e-6))

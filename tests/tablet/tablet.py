"""One tablet in a test: a page with a finger, what it asked for and what it complained of."""

import math
from contextlib import suppress
from dataclasses import dataclass, field
from urllib.parse import urlsplit

import pytest
from playwright.sync_api import Page
from playwright.sync_api import TimeoutError as PlaywrightTimeoutError

from tests.tablet.hand import GoneError, Hand, Point

_TRIES = 5
_ANSWERED_MS = 5000.0
# Whether a finger hits an element at its corners and in its middle.
IS_ON_TOP = """(selector) => {
    const element = document.querySelector(selector);
    const { left, right, top, bottom } = element.getBoundingClientRect();
    const places = [[left + 6, top + 6], [right - 6, top + 6], [left + 6, bottom - 6],
        [right - 6, bottom - 6], [(left + right) / 2, (top + bottom) / 2]];
    return places.every(([x, y]) => element.contains(document.elementFromPoint(x, y)));
}"""


@dataclass
class Tablet:
    """The words on its buttons are English."""

    page: Page
    hand: Hand
    url: str
    asked: list[str] = field(default_factory=list)
    complaints: list[str] = field(default_factory=list)

    def sign_in(self, name: str, pin: str) -> None:
        """By name and PIN, as at the bedside."""
        self.page.goto(self.url)
        self.page.get_by_label("Name").fill(name)
        self.hand.enter(pin)
        self.page.get_by_role("heading", name="Cases, ").wait_for()

    def go_in(self, name: str, pin: str, place: str = "") -> None:
        """Signed in already, as after a reload: at a place of the page."""
        asked = self.page.request.post(f"{self.url}/api/session", data={"name": name, "pin": pin})
        assert asked.ok, asked.text()
        self.page.goto(f"{self.url}/{place}")
        self.page.locator("#app main, #app h1").first.wait_for()

    def is_at(self, state: str, within_s: float = 60.0) -> None:
        """Wait until the screen of this state is shown."""
        self.page.locator(f"main[data-state={state}]").wait_for(timeout=within_s * 1000)

    def press(self, words: str) -> None:
        """The one large button of the screen, as soon as it bears these words and takes a finger."""
        self.hand.tap(self.page.locator(".button.is-primary:not([disabled])", has_text=words))

    def take_control(self) -> None:
        """From nobody, or from whoever has it."""
        self.hand.tap("Control of the case")
        self.page.locator(".control.is-yours, .sheet").first.wait_for()
        if self.page.locator(".sheet").is_visible():
            self.hand.tap("They hand over to me")
        self.page.locator(".control.is-yours").wait_for()

    def leave_hold(self) -> None:
        """Where the case is held: the guide is seen to be empty, and somebody takes note as soon as the arm is read."""
        held = self.page.locator("main[data-state=safe_hold]")
        if held.is_visible():
            self.hand.tap(self.page.locator(".doing .chip", has_text="empty"))
        for _ in range(_TRIES):
            if not held.is_visible():
                return
            # the arm may be read, or lost, just as the finger comes down
            with suppress(PlaywrightTimeoutError, GoneError):
                self.press("Acknowledge")
                held.wait_for(state="hidden", timeout=_ANSWERED_MS)
        pytest.fail("the hold cannot be left")

    def state_fact(self, words: str) -> None:
        """Say what is so, as in every state."""
        self.hand.tap("State a fact")
        self.hand.tap(words)
        self.page.locator(".facts").wait_for(state="hidden")

    def settle(self) -> None:
        """Two frames: what was measured in the first is drawn in the second."""
        self.page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def view(self) -> tuple[float, ...]:
        """How the image is shown, as the page tells: CSS pixels for one of its pixels, its turn in rad, its middle."""
        told = self.page.locator(".stage-image").first.get_attribute("data-view") or ""
        return tuple(float(value) for value in told.split())

    def screen_of(self, pixel_px: Point) -> Point:
        """Where an image pixel is on the glass, by the page's own record of its view and geometry written anew here."""
        view = self.page.locator(".stage-image").first
        box = view.locator("canvas").first.bounding_box()
        assert box is not None
        scale, angle_rad, u0, v0 = self.view()
        offset = complex(pixel_px[0] - u0, pixel_px[1] - v0) * complex(math.cos(angle_rad), math.sin(angle_rad)) * scale
        return box["x"] + box["width"] / 2 + offset.real, box["y"] + box["height"] / 2 + offset.imag

    def pick(self, pixel_px: Point) -> None:
        """Tap where this image pixel is shown, and wait for what the service understood."""
        before = self._told("picked")
        self.hand.tap_at(self.screen_of(pixel_px))
        self.page.wait_for_function(
            "before => document.querySelector('[data-picked]')?.dataset.picked !== before", arg=before
        )
        self.page.locator("[data-understood]").wait_for()

    def picked_px(self) -> Point:
        """The picked pixel as the screen has it, all its digits."""
        u_px, v_px = (self._told("picked") or "").split(",")
        return float(u_px), float(v_px)

    def understood_px(self) -> Point:
        """The pixel that the service drew back."""
        u_px, v_px = (self._told("understood") or "").split(",")
        return float(u_px), float(v_px)

    def _told(self, what: str) -> str | None:
        shown = self.page.locator(f"[data-{what}]")
        return shown.get_attribute(f"data-{what}") if shown.count() else None

    def strangers(self) -> set[str]:
        """Hosts other than the service's own that were asked for anything."""
        own = urlsplit(self.url).netloc
        return {urlsplit(url).netloc for url in self.asked if urlsplit(url).scheme not in ("data", "blob")} - {own}

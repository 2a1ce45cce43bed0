"""One tablet in a test: a page with a finger, what it asked for and what it complained of."""

import math
from dataclasses import dataclass, field
from urllib.parse import urlsplit

from playwright.sync_api import Page

from tests.tablet.hand import Hand, Point


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

    def is_at(self, state: str, within_s: float = 60.0) -> None:
        """Wait until the screen of this state is shown."""
        self.page.locator(f"main[data-state={state}]").wait_for(timeout=within_s * 1000)

    def press(self, words: str) -> None:
        """The one large button of the screen, as soon as it bears these words."""
        self.hand.tap(self.page.locator(".button.is-primary:not([disabled])", has_text=words))

    def screen_of(self, pixel_px: Point) -> Point:
        """Where an image pixel is on the glass, by the page's own record of its view and geometry written anew here."""
        box = self.page.locator(".stage-image").first.bounding_box()
        assert box is not None
        view = self.page.locator(".stage-image").first
        scale, angle_rad, u0, v0 = (float(value) for value in (view.get_attribute("data-view") or "").split())
        offset = complex(pixel_px[0] - u0, pixel_px[1] - v0) * complex(math.cos(angle_rad), math.sin(angle_rad)) * scale
        # the stage has a border of one CSS pixel all around
        return box["x"] + box["width"] / 2 + offset.real, box["y"] + box["height"] / 2 + offset.imag

    def strangers(self) -> set[str]:
        """Hosts other than the service's own that were asked for anything."""
        own = urlsplit(self.url).netloc
        return {urlsplit(url).netloc for url in self.asked if urlsplit(url).scheme not in ("data", "blob")} - {own}

"""A hand on the tablet's glass: real touch events, several fingers, held as long as it likes."""

import time
from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import CDPSession, Locator, Page

Point = tuple[float, float]
_TAP_S = 0.03
_PATIENCE_S = 30.0  # a busy machine's; what is not there by then is gone
_LOOK_AGAIN_MS = 20  # more than a frame
_STEPS = 8


class GoneError(AssertionError):
    """What was to be touched is not on the screen."""


class Hand:
    """Touches one page; points are CSS pixels from its top left."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.glass: CDPSession = page.context.new_cdp_session(page)

    def tap(self, what: str | Locator, exact: bool = False, times: int = 1) -> None:
        """Tap a button by the words on it, or anything by its locator."""
        button = (self.page.get_by_role("button", name=what, exact=exact) if isinstance(what, str) else what).first
        for _ in range(times):
            # In sight, at rest, and the topmost thing there as the finger comes down: what was drawn anew meanwhile is
            # looked for again, and what another thing lies over takes no touch.
            button.tap(timeout=_PATIENCE_S * 1000)

    def tap_at(self, point: Point) -> None:
        """Tap anywhere."""
        with self.touching([point]):
            time.sleep(_TAP_S)

    def type(self, digits: str) -> None:
        """On the keypad that is shown."""
        for digit in digits:
            key = {"-": "Sign", ".": "Decimal point"}.get(digit, digit)
            self.tap(self.page.locator(".pad-keys").get_by_role("button", name=key, exact=True))

    def enter(self, digits: str) -> None:
        """Type, then enter."""
        self.type(digits)
        self.tap(self.page.locator(".pad-keys .is-enter"))

    @contextmanager
    def touching(self, fingers: list[Point]) -> Iterator[None]:
        """Fingers on the glass until the block is left."""
        self.put_down(fingers)
        try:
            yield
        finally:
            self.lift()

    def put_down(self, fingers: list[Point]) -> None:
        """Fingers on the glass, besides none."""
        self._send("touchStart", fingers)

    def move(self, fingers: list[Point]) -> None:
        """The fingers that are down, elsewhere."""
        self._send("touchMove", fingers)

    def lift(self) -> None:
        """All fingers up."""
        self._send("touchEnd", [])

    def cancel(self) -> None:
        """The system takes the touch away, as for a call."""
        self._send("touchCancel", [])

    def drag(self, start: Point, end: Point) -> None:
        """One finger from here to there."""
        self.put_down([start])
        for step in range(1, _STEPS + 1):
            self.move([_between(start, end, step / _STEPS)])
        self.lift()

    def pinch(self, middle: Point, factor: float, reach: float = 60.0, shift: Point = (0.0, 0.0)) -> None:
        """Two fingers about a point, apart by `factor`, their middle shifted meanwhile."""
        for step in range(_STEPS + 1):
            share = step / _STEPS
            spread = reach * (1.0 + (factor - 1.0) * share)
            x, y = middle[0] + shift[0] * share, middle[1] + shift[1] * share
            fingers = [(x - spread, y), (x + spread, y)]
            self.put_down(fingers) if step == 0 else self.move(fingers)
        self.lift()

    def middle_of(self, element: Locator) -> Point:
        """Where a finger would touch it, as soon as it stands still."""
        end_s, box = time.monotonic() + _PATIENCE_S, None
        while time.monotonic() < end_s:
            before, box = box, element.bounding_box()
            if box is not None and box == before:
                return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
            self.page.wait_for_timeout(_LOOK_AGAIN_MS)
        raise GoneError(f"{element} is not on the screen, or does not stand still")

    def _send(self, kind: str, fingers: list[Point]) -> None:
        points = [{"x": x, "y": y, "id": number} for number, (x, y) in enumerate(fingers)]
        self.glass.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def _between(start: Point, end: Point, share: float) -> Point:
    return start[0] + share * (end[0] - start[0]), start[1] + share * (end[1] - start[1])

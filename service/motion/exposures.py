"""The arm's pose during each exposure, latched at its request and watched until the image arrives (H04)."""

from dataclasses import dataclass, replace

from robot.arm import ArmState
from robot.frames import distance_between
from service.motion.displacement import Baseline, Displacement


@dataclass(frozen=True, slots=True, eq=False)
class Exposure:
    """One requested exposure: the pose it was requested at, the largest displacement seen since, until it closed."""

    window_id: str
    latched: ArmState
    baseline: Baseline  # of the ledger at the request
    largest: Displacement
    closed: bool


class Exposures:
    """Requested exposures by window and, once their image is there, by image."""

    def __init__(self) -> None:
        self._by_window: dict[str, Exposure] = {}
        self._by_image: dict[str, Exposure] = {}

    def open(self, window_id: str, latched: ArmState, baseline: Baseline) -> None:
        """Latch the pose; an exposure that was requested before and never came is watched no more."""
        still = {key: replace(one, closed=True) for key, one in self._by_window.items()}
        self._by_window = still | {window_id: Exposure(window_id, latched, baseline, Displacement(0.0, 0.0), False)}

    def observe(self, reading: ArmState) -> None:
        """Keep the largest displacement of every open exposure."""
        for key, one in self._by_window.items():
            if not one.closed:
                offset_mm, angle_rad = distance_between(one.latched.base_from_tcp, reading.base_from_tcp)
                largest = Displacement(max(one.largest.offset_mm, offset_mm), max(one.largest.angle_rad, angle_rad))
                self._by_window[key] = replace(one, largest=largest)

    def of_window(self, window_id: str) -> Exposure | None:
        """The exposure of a window, if it was requested in this run of the service."""
        return self._by_window.get(window_id)

    def assign(self, window_id: str, image_id: str) -> None:
        """The image of a window is there: its pose is that of the window from now on."""
        one = self._by_window.get(window_id)
        if one is not None:
            self._by_image[image_id] = self._by_window[window_id] = replace(one, closed=True)

    def of_image(self, image_id: str) -> Exposure | None:
        """The exposure that an image came from."""
        return self._by_image.get(image_id)

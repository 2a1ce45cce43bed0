"""The arm's pose during each exposure, latched at its request and watched until the image arrives (H04)."""

from collections import OrderedDict
from dataclasses import dataclass, replace

from robot.arm import ArmState
from robot.frames import distance_between
from service.motion.displacement import Baseline, Displacement

# A request that was refused leaves an exposure that nobody will fill; one that is forgotten is unknown, and refuses.
_WATCHED = 8


@dataclass(frozen=True, slots=True, eq=False)
class Exposure:
    """One requested exposure: the pose it was requested at, and the largest displacement until its image."""

    window_id: str
    latched: ArmState
    requested_at_s: float  # as `elapsed_s`
    baseline: Baseline  # of the ledger at the request
    largest: Displacement


class Exposures:
    """Requested exposures by window until their image is there, then by image."""

    def __init__(self) -> None:
        self._by_window: OrderedDict[str, Exposure] = OrderedDict()
        self._by_image: dict[str, Exposure] = {}

    def open(self, window_id: str, latched: ArmState, requested_at_s: float, baseline: Baseline) -> None:
        """Latch the pose; those before it are watched on, for the rules may yet refuse this one."""
        self._by_window[window_id] = Exposure(window_id, latched, requested_at_s, baseline, Displacement(0.0, 0.0))
        while len(self._by_window) > _WATCHED:
            self._by_window.popitem(last=False)

    def observe(self, reading: ArmState) -> None:
        """Remember the largest displacement while an exposure is awaited."""
        for key, one in self._by_window.items():
            offset_mm, angle_rad = distance_between(one.latched.base_from_tcp, reading.base_from_tcp)
            largest = Displacement(max(one.largest.offset_mm, offset_mm), max(one.largest.angle_rad, angle_rad))
            self._by_window[key] = replace(one, largest=largest)

    def of_window(self, window_id: str) -> Exposure | None:
        """The exposure that a window waits for, if it was requested in this run of the service."""
        return self._by_window.get(window_id)

    def assign(self, window_id: str, image_id: str) -> None:
        """The image of a window is there: its pose is that of the window from now on."""
        one = self._by_window.pop(window_id, None)
        if one is not None:
            self._by_image[image_id] = one

    def of_image(self, image_id: str) -> Exposure | None:
        """The exposure that an image came from."""
        return self._by_image.get(image_id)

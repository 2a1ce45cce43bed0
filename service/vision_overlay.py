"""What was found in an image as lines in its raw pixels, so that a screen draws them and projects nothing itself."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from vision.absorption import absorption
from vision.alignment import goal
from vision.inspection import Aim, aim_at
from vision.overlay import BOUNDS_TIMES, bounds_points
from vision.plate import ball_spots
from vision.projection import View, project
from vision.refusal import Refusal
from vision.registered import PixelSpace, Registration
from vision.wire_model import Wire, samples_at
from vision.xray import XrayImage

Array = NDArray[np.float64]
Json = dict[str, Any]
_PLACES = 120  # on a ring
_NAMES = {Wire.SMALL_RING: "small_ring", Wire.BIG_RING: "big_ring", Wire.LINE: "line"}
_STEPS = 20  # of the straight way there, which a bent image bends
_DECIMALS = 2  # of a pixel: finer than any screen shows


def outlines(image: XrayImage, registration: Registration, targets: Sequence[Json]) -> Json | Refusal:
    """Wires, fiducials, bead, balls, every target, the newest one's bounds, the way there and the guide at its goal."""
    newest = targets[-1] if targets else None
    aim = None if newest is None else _aim(registration, newest)
    if isinstance(aim, Refusal):
        return aim
    raw, bead = registration.distortion.raw_from_corrected, registration.bead_px
    return {
        "wires": _wires(registration, registration.view()),
        "fiducials": {name: _pairs(raw(point[None]))[0] for name, point in registration.fiducials_px.items()},
        "bead": None if bead is None else _pairs(raw(bead[None]))[0],
        "balls": _pairs(_balls(image, registration)),
        "targets": list(targets),
        "bounds": [] if aim is None else _pairs(raw(bounds_points(aim))),
        "bounds_times": BOUNDS_TIMES,
        **_ahead(registration, aim),
    }


def _aim(registration: Registration, target: Json) -> Aim | Refusal:
    u_px, v_px = target["raw_px"]
    return aim_at(registration, (u_px, v_px), PixelSpace.RAW, target["depth_mm"])


def _wires(registration: Registration, view: View) -> dict[str, list[tuple[float, float]]]:
    guide, turn = registration.guide, np.linspace(0.0, 2.0 * np.pi, _PLACES + 1)
    along = np.linspace(guide.line_start_mm, guide.line_end_mm, _PLACES)
    samples = samples_at(view, guide, [turn, turn, along])
    raw = registration.distortion.raw_from_corrected(samples.points)
    return {name: _pairs(raw[samples.wire == wire]) for wire, name in _NAMES.items()}


def _ahead(registration: Registration, aim: Aim | None) -> Json:
    """The wires at the goal, and the way of the small ring's centre there."""
    if aim is None:
        return {"goal": {}, "way": []}
    here = registration.view()
    guide_from_goal, _ = goal(here, aim.pixel)
    there = View(registration.intrinsics, registration.source_from_guide @ guide_from_goal)
    way = project(here, np.linspace(0.0, 1.0, _STEPS + 1)[:, None] * guide_from_goal[:3, 3])
    return {"goal": _wires(registration, there), "way": _pairs(registration.distortion.raw_from_corrected(way))}


def _balls(image: XrayImage, registration: Registration) -> Array:
    """Spots of the plate's size, raw pixels; none for a C-arm without a plate."""
    plate = registration.carm.plate
    if plate is None:
        return np.zeros((0, 2))
    return ball_spots(absorption(image), plate, registration.distortion.pixel_size_mm)


def _pairs(points: Array) -> list[tuple[float, float]]:
    return [(float(u), float(v)) for u, v in np.round(points, _DECIMALS)]

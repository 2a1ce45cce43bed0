"""Whole ways from X-ray to a placed guide, in the same rooms: exposures, error, time.

Time is modelled, except for this project's own computing: the figures below, for every strategy the same.
"""

import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from benchmarks.side_by_side.biplanar import place_biplanar
from benchmarks.side_by_side.pictures import INTENSIFIER, ROOM_GUIDE, received
from benchmarks.side_by_side.servoing import place_by_servoing
from benchmarks.side_by_side.theatre import GuideErrors, Theatre
from simulator.carm.stand import Stand
from vision.refusal import Refusal
from vision.registered import PixelSpace, Registration
from vision.registration import register
from vision.targeting import target

Array = NDArray[np.float64]

EXPOSURE_S = 20.0  # people step back, pedal, image sent
MOVE_S = 8.0  # plan, approval, held motion
CARM_TURN_S = 45.0  # to a second view
PHANTOM_S = 150.0  # a phantom placed, touched by the arm at six places, taken away


@dataclass(frozen=True, slots=True)
class Outcome:
    """One strategy in one room; errors None where it gave up."""

    strategy: str
    room: int
    exposures: int
    errors: GuideErrors | None
    time_s: float


OWN_FIRST = "this project, 1 image, before verification"
OWN = "this project, 1 + 1 images"
BIPLANAR = "biplanar, phantom, arm registered by touch"
FULL_STEPS, HALF_STEPS = "visual servoing, full steps", "visual servoing, half steps"


def outcomes(seed: int) -> list[Outcome]:
    """Every strategy in the room of a seed."""
    return [
        *_own(seed),
        _run(BIPLANAR, seed, place_biplanar, CARM_TURN_S + PHANTOM_S),
        _run(FULL_STEPS, seed, lambda theatre: place_by_servoing(theatre, 1.0), 0.0),
        _run(HALF_STEPS, seed, lambda theatre: place_by_servoing(theatre, 0.5), 0.0),
    ]


def _run(name: str, seed: int, place: Callable[[Theatre], GuideErrors], more_s: float) -> Outcome:
    theatre = Theatre(seed)
    errors = place(theatre)
    time_s = theatre.exposures * EXPOSURE_S + theatre.moves * MOVE_S + more_s
    return Outcome(name, seed, theatre.exposures, errors, time_s)


def _own(seed: int) -> list[Outcome]:
    """Register, target, move; verify, and correct from the verification image without another exposure."""
    theatre, started_s = Theatre(seed), time.process_time()
    stand = theatre.stand(theatre.angles)
    theatre.lead_by_hand(stand)
    outcomes, pixel = [], None
    for name in (OWN_FIRST, OWN):
        pixel = _move_once(theatre, stand, pixel)
        time_s = theatre.exposures * EXPOSURE_S + theatre.moves * MOVE_S + time.process_time() - started_s
        errors = None if pixel is None else theatre.errors(stand)
        outcomes.append(Outcome(name, seed, theatre.exposures, errors, time_s))
    return outcomes


def _move_once(theatre: Theatre, stand: Stand, pixel: Array | None) -> Array | None:
    """The raw pixel that was aimed at, picked if there is none yet; None where the image was refused."""
    scene = theatre.expose(stand)
    if pixel is None:
        pixel = scene.distortion.raw_from_ideal(theatre.picked(scene, theatre.pedicle.target_in_patient))
    registration = register(received(theatre.pixels(scene)), ROOM_GUIDE, INTENSIFIER)
    if not isinstance(registration, Registration):
        return None
    aimed = target(registration, (float(pixel[0]), float(pixel[1])), PixelSpace.RAW)
    if isinstance(aimed, Refusal):
        return None
    theatre.move(theatre.base_from_guide @ aimed.guide_from_goal)
    return pixel

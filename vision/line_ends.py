"""The two ends of the indicator line: where its absorption has fallen to half."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import least_squares
from scipy.special import erf

from vision.devices import Guide
from vision.profiles import ProfileReader
from vision.projection import View, project
from vision.wire_model import Wire, WireSamples

Array = NDArray[np.float64]

_REACH_PX = 10.0
_STEP_PX = 0.5
_SEEN_AROUND_PX = 2.5  # of the step: twice the blur's reach
_STEP_SD = 0.1  # of the line's absorption: what the ground does to a profile
_PLATEAU_SD = 0.1  # the same, of the heights before and beyond the step
_LEAST_BLUR_PX = 0.3  # standard deviation of the step's own blur: no detector is sharper
_LEAST_SD_PX = 0.25  # the blur of a step in intensity moves its half in absorption by 0.15 px; a cut is not square
_GREATEST_SD_PX = 1.0  # beyond it an end is not seen
_SAMPLES_IN_ONE = 4.0  # samples half a pixel apart, noise and ground that agree over two
_BALL_MARGIN = 0.8  # of a profile's reach, kept free around a ball


@dataclass(frozen=True, slots=True)
class LineEnd:
    """A measured end: x of the fiducial in the guide frame, mm; how far beyond its projection it lies, and sd, px."""

    x_mm: float
    excess_px: float
    amplitude: float
    sd_px: float


def measure_line_ends(
    view: View, guide: Guide, reader: ProfileReader, samples: WireSamples, balls: Array
) -> list[LineEnd]:
    """Those ends that neither a ring nor a ball covers and that are clear to a pixel; excess counts outwards.

    Parameters
    ----------
    view, guide
        The present estimate.
    reader : ProfileReader
        Of the image.
    samples : WireSamples
        Of all wires, by the same view.
    balls : Array
        (n, 3), corrected pixel and radius in px.
    """
    points = project(view, np.array([[guide.line_start_mm, 0.0, 0.0], [guide.line_end_mm, 0.0, 0.0]]))
    along = (points[1] - points[0]) / np.linalg.norm(points[1] - points[0])
    rings = samples.points[samples.wire != Wire.LINE]
    ends = []
    for x_mm, point, outwards in ((guide.line_start_mm, points[0], -along), (guide.line_end_mm, points[1], along)):
        steps = np.arange(-_REACH_PX, _REACH_PX + _STEP_PX / 2.0, _STEP_PX)
        places = point + steps[:, None] * outwards
        free = _free(places, rings, balls, reader)
        if (free & (steps < -2.0)).sum() < 6 or (free & (steps > 2.0)).sum() < 6:
            continue
        normals = np.broadcast_to((-along[1], along[0]), places.shape)
        end = _step_fit(x_mm, steps[free], reader.amplitude_at(places, normals)[free])
        # the step itself must be seen, not only both its sides
        if end.sd_px <= _GREATEST_SD_PX and free[np.abs(steps - end.excess_px) < _SEEN_AROUND_PX].all():
            ends.append(end)
    return ends


def _free(places: Array, rings: Array, balls: Array, reader: ProfileReader) -> NDArray[np.bool_]:
    """Places (n,) whose whole profile no ring and no ball disturbs."""
    clear_px = reader.reach_px + 2.0 * reader.crest_sd_px
    free = ~_is_near(places, rings, np.full(len(rings), clear_px))
    return np.asarray(free & ~_is_near(places, balls[:, :2], balls[:, 2] + _BALL_MARGIN * reader.reach_px))


def _is_near(places: Array, others: Array, within_px: Array) -> NDArray[np.bool_]:
    """Which places (n, 2) lie nearer to any of the others (m, 2) than it allows (m,)."""
    low, high = places.min(axis=0), places.max(axis=0)
    around = ((others > low - within_px[:, None]) & (others < high + within_px[:, None])).all(axis=1)
    apart = places[:, None] - others[around]
    return np.asarray(((apart**2).sum(axis=2) <= within_px[around] ** 2).any(axis=1))


def _step_fit(x_mm: float, steps: Array, amplitude: Array) -> LineEnd:
    """Where the absorption falls to half; beyond the end there is none, whatever the ground there pretends."""
    inner = float(np.median(amplitude[steps < -2.0]))
    scale = max(abs(inner), 1e-6)

    held = _STEP_SD / _PLATEAU_SD / scale

    def excess(parameters: Array) -> Array:
        place, height, ground, width = parameters
        wave = 0.5 * (1.0 - erf((steps - place) / (math.sqrt(2.0) * max(width, _LEAST_BLUR_PX))))
        left = (ground + height * wave - amplitude) / scale
        return np.concatenate((left, ((height - inner) * held, ground * held)))

    def slopes(parameters: Array) -> Array:
        place, height, _, width = parameters
        blur_px = max(width, _LEAST_BLUR_PX)
        away = (steps - place) / blur_px
        crest = height / (math.sqrt(2.0 * math.pi) * blur_px * scale) * np.exp(-(away**2) / 2.0)
        table = np.zeros((len(steps) + 2, 4))
        table[:-2, 0], table[:-2, 1] = crest, 0.5 * (1.0 - erf(away / math.sqrt(2.0))) / scale
        table[:-2, 2], table[:-2, 3] = 1.0 / scale, crest * away * (width > _LEAST_BLUR_PX)
        table[-2, 1] = table[-1, 2] = held
        return table

    solved = least_squares(excess, (0.0, inner, 0.0, 1.2), slopes, loss="soft_l1", f_scale=_STEP_SD)
    left = excess(solved.x)[:-2]
    by_place = float(np.linalg.pinv(solved.jac.T @ solved.jac)[0, 0])
    sd_px = math.sqrt(_LEAST_SD_PX**2 + by_place * _SAMPLES_IN_ONE * float(np.mean(left**2)))
    return LineEnd(x_mm, float(np.clip(solved.x[0], -_REACH_PX, _REACH_PX)), float(solved.x[1]), sd_px)

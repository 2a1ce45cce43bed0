"""Residuals unrolled along each wire: which arc, which crossing, which piece of the line is off."""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.inspection import WireResiduals
from vision.panel import Colour, Picture, write
from vision.wire_model import Wire

Array = NDArray[np.float64]

_GROUND, _GRID, _TEXT = (24, 24, 24), (70, 70, 70), (200, 200, 200)
_MEAN = (255, 255, 255)
_REJECTED = (70, 70, 255)
_REACH_PX = 0.35  # corrected px from the middle of a strip to its edge
_MARGIN = 160  # left of the strip, for its name
_LEVEL_PX = 0.2  # of the lines that show the scale
_GAP = 4.0  # median distances of neighbours: beyond it something crosses the wire
_RUNNING = 5  # neighbours in the running mean: the noise of single pieces averages out, waves stay


def draw_strips(residuals: WireResiduals, colours: dict[Wire, Colour], width: int, height: int) -> Picture:
    """One strip below another, (3 height, width): residual against the place on the wire."""
    return np.vstack([_strip(residuals, wire, colours[wire], width, height) for wire in Wire])


def _strip(residuals: WireResiduals, wire: Wire, colour: Colour, width: int, height: int) -> Picture:
    picture = np.full((height, width, 3), _GROUND, dtype=np.uint8)
    on = residuals.wire == wire
    along, residual, weight = residuals.along[on], residuals.residual_px[on], residuals.weight[on]
    low, high = _range(wire, along)
    columns = _MARGIN + (along - low) / (high - low) * (width - _MARGIN - 10)
    levels = np.array([-_LEVEL_PX, 0.0, _LEVEL_PX])
    for level, row in zip(levels, np.rint(_rows(levels, height)).astype(int), strict=True):
        picture[row, _MARGIN:] = _GRID
        write(picture, f"{level:+.1f}" if level else "0", (_MARGIN - 34, int(row) + 4), _TEXT, 0.35)
    for place in _ticks(wire, low, high):
        column = round(_MARGIN + (place - low) / (high - low) * (width - _MARGIN - 10))
        picture[:, column] = _GRID
        words = f"{place:.0f} mm" if wire is Wire.LINE else f"{math.degrees(place):.0f} deg"
        write(picture, words, (min(column + 4, width - 60), height - 6), _TEXT, 0.4)
    rows, kept = _rows(residual, height), weight > 0.0
    _dots(picture, columns[kept], rows[kept], colour, 2)
    _dots(picture, columns[~kept], rows[~kept], _REJECTED, 2)
    for mean in _means(columns[kept], rows[kept]):
        cv2.polylines(picture, [np.rint(mean * 16.0).astype(np.int32)], False, _MEAN, 2, cv2.LINE_AA, 4)
    _name(picture, wire, residual, weight)
    return picture


def _range(wire: Wire, along: Array) -> tuple[float, float]:
    if wire is not Wire.LINE:
        return 0.0, 2.0 * math.pi
    return (float(along.min()) - 0.5, float(along.max()) + 0.5) if len(along) else (0.0, 1.0)


def _ticks(wire: Wire, low: float, high: float) -> Array:
    if wire is Wire.LINE:
        return np.asarray(np.arange(math.ceil(low / 10.0) * 10.0, high, 10.0))
    return np.asarray(np.radians(np.arange(0.0, 360.0, 30.0)))


def _rows(residual_px: Array, height: int) -> Array:
    """Rows (n,) of residuals (n,); those beyond the strip lie on its edge."""
    share = np.clip(residual_px, -_REACH_PX, _REACH_PX) / (2.0 * _REACH_PX)
    return np.asarray((0.5 - share) * (height - 1))


def _dots(picture: Picture, columns: Array, rows: Array, colour: Colour, radius: int) -> None:
    for column, row in np.rint(np.column_stack((columns, rows))).astype(int).tolist():
        cv2.circle(picture, (column, row), radius, colour, cv2.FILLED, cv2.LINE_AA)


def _means(columns: Array, rows: Array) -> list[Array]:
    """Running means (n, 2) of neighbours, one piece for each stretch without a gap."""
    step = np.diff(columns)
    gaps = np.nonzero(step > _GAP * np.median(step))[0] + 1 if len(step) else step.astype(np.intp)
    kernel = np.full(_RUNNING, 1.0 / _RUNNING)
    return [
        np.column_stack([np.convolve(axis, kernel, "valid") for axis in piece.T])
        for piece in np.split(np.column_stack((columns, rows)), gaps)
        if len(piece) >= _RUNNING
    ]


def _name(picture: Picture, wire: Wire, residual: Array, weight: Array) -> None:
    words = [wire.name.replace("_", " ").lower(), f"{int((weight > 0.0).sum())} of {len(weight)}"]
    if weight.sum() > 0.0:
        words.append(f"rms {math.sqrt(float(np.average(residual**2, weights=weight))):.3f} px")
    for line, text in enumerate(words):
        write(picture, text, (6, 24 + 22 * line), _TEXT, 0.45)

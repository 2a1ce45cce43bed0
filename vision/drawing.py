"""The picture of an inspection: the whole corrected image, the guide enlarged, the residuals unrolled below."""

import math

import cv2
import numpy as np
from numpy.typing import NDArray

from vision import overlay
from vision.inspection import Aim, Inspection
from vision.panel import Panel, Picture, write
from vision.refusal import Refusal
from vision.registered import Registration
from vision.strips import draw_strips

Array = NDArray[np.float64]

_SIDE = 1000  # of each of the two panels
_STRIP_HEIGHT = 130
_HEAD = 40
_HEAD_GROUND = (24, 24, 24)
_AROUND = 1.2  # the guide's extent that the enlarged panel shows
_DARKEST_PERCENT, _LIGHTEST_PERCENT = 0.5, 99.5  # of the pixels, stretched from black to white
_DIMMED = 0.75  # the image's brightness under what is drawn on it
_GAMMA = 0.6  # shows what lies in the shadows of dense bone


def draw(inspection: Inspection) -> Picture:
    """The picture (rows, columns, 3), blue, green, red."""
    pixels = inspection.pixels
    corner, width_px = _window(inspection, pixels.shape)
    whole = Panel(_grey(pixels, pixels), (0.0, 0.0), float(max(pixels.shape)), _SIDE)
    near = Panel(_grey(pixels, _cut(pixels, corner, width_px)), corner, width_px, _SIDE)
    overlay.draw_balls(whole, inspection)
    for panel in (whole, near):
        _draw_guide(panel, inspection)
    for view in inspection.views:
        overlay.draw_residuals(near, view)
    if isinstance(inspection.aim, Aim):
        overlay.draw_aim(near, inspection.aim)
    residuals = [view.residuals for view in inspection.views if view.residuals is not None]
    strips = [draw_strips(one, overlay.WIRE_COLOURS, 2 * _SIDE, _STRIP_HEIGHT) for one in residuals]
    return np.vstack([_head(inspection), np.hstack((whole.picture, near.picture)), *strips])


def png(picture: Picture) -> bytes:
    """The picture as a PNG file."""
    _, data = cv2.imencode(".png", picture)
    return bytes(data.tobytes())


def _draw_guide(panel: Panel, inspection: Inspection) -> None:
    if isinstance(inspection.result, Refusal):
        overlay.draw_rings(panel, inspection)
    for view in inspection.views:
        overlay.draw_wires(panel, view)
    if isinstance(inspection.result, Registration):
        overlay.draw_fiducials(panel, inspection.result)


def _cut(pixels: NDArray[np.float32], corner: tuple[float, float], width_px: float) -> NDArray[np.float32]:
    """The pixels of a window, as far as it is on the image."""
    (left, right), (top, bottom) = ((max(0, int(start)), max(0, int(start + width_px) + 1)) for start in corner)
    return pixels[top:bottom, left:right]


def _grey(pixels: NDArray[np.float32], stretched_by: NDArray[np.float32]) -> NDArray[np.uint8]:
    """The image, stretched so that a part of it spans black to white."""
    lit = stretched_by[stretched_by > 0.0]
    low, high = np.percentile(lit, (_DARKEST_PERCENT, _LIGHTEST_PERCENT)) if len(lit) else (0.0, 1.0)
    stretched = np.clip((pixels - low) / max(float(high - low), 1e-6), 0.0, 1.0)
    return np.asarray(stretched**_GAMMA * (255.0 * _DIMMED), dtype=np.uint8)


def _window(inspection: Inspection, shape: tuple[int, ...]) -> tuple[tuple[float, float], float]:
    """Corner and width, corrected pixels, of a square around what was found of the guide."""
    points = [view.wires.points for view in inspection.views]
    points += [overlay.bead_places(view) for view in inspection.views]
    if not points:
        points = [overlay.ellipse_points(ring.ellipse) for ring in inspection.rings[: overlay.MOST_CANDIDATES]]
    if not points:
        return (0.0, 0.0), float(max(shape))
    low, high = np.vstack(points).min(axis=0), np.vstack(points).max(axis=0)
    width_px = _AROUND * float((high - low).max())
    u, v = (low + high) / 2.0 - width_px / 2.0
    return (float(u), float(v)), width_px


def _head(inspection: Inspection) -> Picture:
    picture = np.full((_HEAD, 2 * _SIDE, 3), _HEAD_GROUND, dtype=np.uint8)
    result = inspection.result
    colour = overlay.REJECTED if isinstance(result, Refusal) else overlay.TEXT
    write(picture, summary(inspection), (8, 26), colour, 0.55)
    times = f"arrows x {overlay.RESIDUALS_TIMES:g}, balls x {overlay.BALLS_TIMES:g}, bounds x {overlay.BOUNDS_TIMES:g}"
    write(picture, times, (2 * _SIDE - 380, 26), overlay.TEXT, 0.45)
    return picture


def summary(inspection: Inspection) -> str:
    """One line: the bounds of a registration, or why there is none."""
    result = inspection.result
    if isinstance(result, Refusal):
        measured = "" if result.measured is None else f": {result.measured:.3g}"
        limit = "" if result.limit is None else f", limit {result.limit:.3g}"
        return f"refused, {result.code.value}. {result.message}{measured}{limit}"
    bounds = inspection.aim.bounds_95 if isinstance(inspection.aim, Aim) else result.predicted_error_95
    angle_deg = math.degrees(bounds.angle_rad)
    return (
        f"registered: residual {result.residual_rms_px:.3f} px, {result.distortion.balls} balls, "
        f"within {angle_deg:.3f} deg and {bounds.position_mm:.3f} mm (95 %)"
    )

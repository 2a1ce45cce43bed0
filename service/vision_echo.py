"""A picked point drawn back into its image, so that the surgeon sees what the server understood (H08)."""

import base64

import cv2
import numpy as np
from numpy.typing import NDArray

_HALF_PX = 48
_SCALE = 4
_ARM_PX = 28  # of the cross, in the enlarged crop; its middle is left open so that the anatomy shows
_GAP_PX = 6
# A bright line on a dark one, seen at arm's length on bone and on air: colour (BGR) and width.
_STROKES = (((0, 0, 0), 7), ((0, 220, 255), 3))


def draw_point(pixels: NDArray[np.float32], raw_px: tuple[float, float]) -> dict[str, object]:
    """A crop of (rows, columns) pixels around a raw pixel (u, v), enlarged, with a cross at the point, as PNG.

    The crop's top-left pixel is `crop_origin_px` of the raw image; the enlarged crop has `crop_scale` pixels for one.
    """
    rows, columns = pixels.shape
    left = int(np.clip(round(raw_px[0]) - _HALF_PX, 0, max(columns - 2 * _HALF_PX, 0)))
    top = int(np.clip(round(raw_px[1]) - _HALF_PX, 0, max(rows - 2 * _HALF_PX, 0)))
    crop = _windowed(pixels[top : top + 2 * _HALF_PX, left : left + 2 * _HALF_PX])
    enlarged = cv2.resize(crop, None, fx=_SCALE, fy=_SCALE, interpolation=cv2.INTER_CUBIC)
    picture = cv2.cvtColor(enlarged, cv2.COLOR_GRAY2BGR)
    _cross(picture, (raw_px[0] - left, raw_px[1] - top))
    _, png = cv2.imencode(".png", picture)
    return {
        "crop_png_base64": base64.b64encode(png.tobytes()).decode(),
        "crop_origin_px": [left, top],
        "crop_scale": _SCALE,
    }


def _windowed(crop: NDArray[np.float32]) -> NDArray[np.uint8]:
    low, high = np.percentile(crop, (1.0, 99.0))
    levels: NDArray[np.uint8] = np.clip((crop - low) / max(high - low, 1e-6) * 255.0, 0.0, 255.0).astype(np.uint8)
    return levels


def _cross(picture: NDArray[np.uint8], point_px: tuple[float, float]) -> None:
    # The centre of crop pixel 0 is at (scale - 1) / 2 of the enlarged one.
    u_px, v_px = (round(_SCALE * value + (_SCALE - 1) / 2) for value in point_px)
    for colour, width in _STROKES:
        for du, dv in ((1, 0), (-1, 0), (0, 1), (0, -1)):
            start = (u_px + du * _GAP_PX, v_px + dv * _GAP_PX)
            cv2.line(picture, start, (u_px + du * _ARM_PX, v_px + dv * _ARM_PX), colour, width)

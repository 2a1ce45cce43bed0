"""The image as absorption: the logarithm of intensity, in which what the beam crosses adds up.

A display gamma only scales it. The field (the intensifier's round window, a collimator) is where any beam arrived.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.xray import XrayImage

_DARKEST_STEPS = 0.5  # steps of the image's depth; below it the logarithm only shows rounding
_DARKEST = 1e-4  # of full scale; below it deep images show but noise
_FIELD_DARKER_THAN = 0.004  # of full scale: no beam
_FIELD_CELLS = 256  # along the longer side: the field's edge need not be known better, and a cell of it is left out


@dataclass(frozen=True, slots=True, eq=False)
class Absorption:
    """Negative logarithm of the intensity (rows, columns), and where the field is."""

    values: NDArray[np.float32]
    inside: NDArray[np.bool_]

    @property
    def field_area_px(self) -> float:
        """Pixels inside the field."""
        return float(np.count_nonzero(self.inside))


def absorption(image: XrayImage) -> Absorption:
    """Absorption of an image and its field: the largest region with beam, its own dark places filled."""
    values = cv2.max(image.pixels, max(_DARKEST, _DARKEST_STEPS / (2.0**image.bits - 1.0)))
    cv2.log(values, values)
    np.negative(values, out=values)
    return Absorption(values, _field(image.pixels))


def _field(pixels: NDArray[np.float32]) -> NDArray[np.bool_]:
    """Where the beam arrived (rows, columns): the hull of the largest lit region, less one cell of its border."""
    cell_px = max(1, max(pixels.shape) // _FIELD_CELLS)
    rows, columns = pixels.shape
    cells = cv2.resize(pixels, (columns // cell_px, rows // cell_px), interpolation=cv2.INTER_AREA)
    lit = (cells > _FIELD_DARKER_THAN).astype(np.uint8)
    contours, _ = cv2.findContours(lit, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    field = np.zeros_like(lit)
    if contours:
        hull = cv2.convexHull(max(contours, key=cv2.contourArea))
        cv2.drawContours(field, [hull], -1, 1, cv2.FILLED)
    field = cv2.erode(field, np.ones((3, 3), np.uint8), borderType=cv2.BORDER_CONSTANT, borderValue=0)
    return np.asarray(cv2.resize(field, (columns, rows), interpolation=cv2.INTER_NEAREST).view(bool))

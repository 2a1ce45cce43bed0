"""The image as absorption: the logarithm of intensity, in which what the beam crosses adds up.

A display gamma only scales it. The field (the intensifier's round window, a collimator) is where any beam arrived.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.xray import XrayImage

_DARKEST = 0.002  # of full scale; half a step of an 8-bit image, below which the logarithm only shows rounding
_FIELD_DARKER_THAN = 0.004  # of full scale: no beam
_BORDER_PX = 3


@dataclass(frozen=True, slots=True, eq=False)
class Absorption:
    """Negative logarithm of the intensity (rows, columns), and where the field is."""

    values: NDArray[np.float32]
    inside: NDArray[np.bool_]

    @property
    def field_area_px(self) -> float:
        """Pixels inside the field."""
        return float(self.inside.sum())

    def curvatures(self, sigma_px: float) -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
        """Second derivatives uu, uv, vv (rows, columns) of minus the smoothed absorption, times sigma squared.

        A dark spot is positive.
        """
        scale = np.float32(sigma_px**2)
        along_u, along_v = self.slopes(sigma_px)
        return (
            -scale * np.gradient(along_u, axis=1),
            -scale * np.gradient(along_u, axis=0),
            -scale * np.gradient(along_v, axis=0),
        )

    def slopes(self, sigma_px: float) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """First derivatives along u and v (rows, columns) of the smoothed absorption."""
        smooth = cv2.GaussianBlur(self.values, (0, 0), sigma_px, borderType=cv2.BORDER_REPLICATE)
        return np.gradient(smooth, axis=1), np.gradient(smooth, axis=0)

    def lesser_curvature(self, sigma_px: float) -> NDArray[np.float32]:
        """The smaller eigenvalue of the second derivatives: large at dark spots, small along wires and edges."""
        uu, uv, vv = self.curvatures(sigma_px)
        lesser: NDArray[np.float32] = (uu + vv) / 2.0 - np.sqrt((uu - vv) ** 2 / 4.0 + uv**2)
        return lesser


def absorption(image: XrayImage) -> Absorption:
    """Absorption of an image and its field: the largest region with beam, its own dark places filled."""
    lit = (cv2.GaussianBlur(image.pixels, (0, 0), 2.0) > _FIELD_DARKER_THAN).astype(np.uint8)
    contours, _ = cv2.findContours(lit, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    field = np.zeros_like(lit)
    if contours:
        hull = cv2.convexHull(max(contours, key=cv2.contourArea))
        cv2.drawContours(field, [hull], -1, 1, cv2.FILLED)
    field[[0, -1], :] = field[:, [0, -1]] = 0
    kernel = np.ones((2 * _BORDER_PX + 1, 2 * _BORDER_PX + 1), np.uint8)
    values = -np.log(np.maximum(image.pixels, np.float32(_DARKEST)))
    return Absorption(values, cv2.erode(field, kernel).astype(bool))

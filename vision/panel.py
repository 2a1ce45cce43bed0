"""A piece of a picture that shows a window of an image's corrected pixels, enlarged, and draws on it."""

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]
Colour = tuple[int, int, int]  # blue, green, red, as OpenCV has them

_SHIFT = 4  # fractional bits of OpenCV's coordinates: lines lie where they are, not on the nearest pixel
_FONT = cv2.FONT_HERSHEY_SIMPLEX


class Panel:
    """A square window of corrected pixels as a picture of `side` pixels."""

    def __init__(self, grey: NDArray[np.uint8], corner: tuple[float, float], width_px: float, side: int) -> None:
        """`grey` (rows, columns) is cut at `corner` (u, v), `width_px` wide, corrected pixels."""
        self._corner, self._scale = np.array(corner), side / width_px
        u, v = self._corner - 0.5 * (1.0 - 1.0 / self._scale)
        inverse = np.array([[1.0 / self._scale, 0.0, u], [0.0, 1.0 / self._scale, v]])
        flags = cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP
        cut = cv2.warpAffine(grey, inverse, (side, side), flags=flags, borderMode=cv2.BORDER_CONSTANT)
        self.picture: Picture = np.asarray(cv2.cvtColor(cut, cv2.COLOR_GRAY2BGR), dtype=np.uint8)

    def path(self, points: Array, colour: Colour, thickness: int = 1, *, closed: bool = False) -> None:
        """A line through points (n, 2)."""
        cv2.polylines(self.picture, [self._fixed(points)], closed, colour, thickness, cv2.LINE_AA, _SHIFT)

    def strokes(self, starts: Array, ends: Array, colour: Colour, thickness: int = 1) -> None:
        """A stroke from each start (n, 2) to its end (n, 2)."""
        pieces = list(np.stack((self._fixed(starts), self._fixed(ends)), axis=1))
        cv2.polylines(self.picture, pieces, False, colour, thickness, cv2.LINE_AA, _SHIFT)

    def circles(self, centres: Array, radius: float, colour: Colour, thickness: int = 1) -> None:
        """Circles about points (n, 2); the radius in pixels of the picture."""
        for u, v in self._fixed(centres):
            size = round(radius * 2**_SHIFT)
            cv2.circle(self.picture, (int(u), int(v)), size, colour, thickness, cv2.LINE_AA, _SHIFT)

    def crosses(self, centres: Array, arm: float, colour: Colour, thickness: int = 1) -> None:
        """Upright crosses at points (n, 2); the arm in pixels of the picture."""
        for way in np.eye(2) * arm / self._scale:
            self.strokes(centres - way, centres + way, colour, thickness)

    def text(self, words: str, at: Array, colour: Colour, offset: tuple[int, int] = (6, -6)) -> None:
        """Words beside a point (2,), with a dark rim so that they read on any ground."""
        u, v = (self._fixed(at[None])[0] >> _SHIFT) + offset
        write(self.picture, words, (int(u), int(v)), colour)

    def _fixed(self, points: Array) -> NDArray[np.int32]:
        """Coordinates (n, 2) in the picture as OpenCV's fixed-point numbers, kept where they cannot overflow."""
        placed = (np.asarray(points, dtype=np.float64) - self._corner + 0.5) * self._scale - 0.5
        return np.asarray(np.rint(np.clip(placed, -1e4, 1e4) * 2**_SHIFT), dtype=np.int32)


def write(picture: Picture, words: str, at: tuple[int, int], colour: Colour, size: float = 0.5) -> None:
    """Words with their baseline's start at a pixel (column, row) of a picture."""
    cv2.putText(picture, words, at, _FONT, size, (0, 0, 0), 3, cv2.LINE_AA)
    cv2.putText(picture, words, at, _FONT, size, colour, 1, cv2.LINE_AA)

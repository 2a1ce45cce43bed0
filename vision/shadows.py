"""The shadows that cross a wire: the plate's balls and the guide's bead, drawn where the raw pixels are."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.distortion import DistortionMap
from vision.wire_shape import Profile

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class Window:
    """A part of the raw image: first column and row, number of columns and rows."""

    left: int
    top: int
    columns: int
    rows: int

    @classmethod
    def around(cls, raw: Array, margin_px: float, rows: int, columns: int) -> "Window":
        """The part of an image that holds raw pixels (n, 2) with a margin."""
        low = np.clip(np.floor(raw.min(axis=0) - margin_px), 0, (columns - 1, rows - 1)).astype(int)
        high = np.clip(np.ceil(raw.max(axis=0) + margin_px) + 1, low + 1, (columns, rows)).astype(int)
        (left, top), (width, height) = low.tolist(), (high - low).tolist()
        return cls(left, top, width, height)

    def cut(self, image: NDArray[np.float32]) -> NDArray[np.float32]:
        """That part of an image (rows, columns)."""
        return image[self.top : self.top + self.rows, self.left : self.left + self.columns]


def ball_shadows(window: Window, balls_raw: Array, distortion: DistortionMap, profile: Profile) -> Array:
    """The sum of balls' shadows.

    Parameters
    ----------
    window : Window
        Where to draw.
    balls_raw : Array
        (m, 2), raw pixels of their centres.
    distortion : DistortionMap
        In whose corrected pixels the balls are round.
    profile : Profile
        From a ball's centre outwards.

    Returns
    -------
    Array
        (rows, columns) of the window, 1 at a ball's centre.
    """
    drawn = np.zeros((window.rows, window.columns))
    reach = int(np.ceil(profile.reach_px))
    middle = np.rint(balls_raw).astype(np.intp)
    corner = middle - (window.left, window.top)
    whole = np.all((corner >= reach) & (corner < (window.columns - reach, window.rows - reach)), axis=1)
    if not whole.any():
        return drawn
    balls_raw, middle, corner = balls_raw[whole], middle[whole], corner[whole]
    steps = np.arange(-reach, reach + 1)
    steps_v, steps_u = (axis.ravel() for axis in np.meshgrid(steps, steps, indexing="ij"))
    away = np.stack((steps_u, steps_v), axis=1) + (middle - balls_raw)[:, None, :]
    away = away @ distortion.jacobian(balls_raw).transpose(0, 2, 1)
    heights = profile.heights(np.sqrt(np.einsum("mpi,mpi->mp", away, away)))
    np.add.at(drawn, (corner[:, 1, None] + steps_v, corner[:, 0, None] + steps_u), heights)
    return drawn

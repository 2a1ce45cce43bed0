"""One corrected grid for two images of one C-arm pose.

Each corrected grid is laid by the balls that were found in its own image, so two of them differ by a similarity of some
tenths of a pixel. What compares two images brings the second one's grid onto the first one's.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.distortion import DistortionMap
from vision.projection import View

Array = NDArray[np.float64]

_REACH = 0.8  # of the half size: inside the round field, where both maps rest on balls
_SAMPLES = 21  # a side


@dataclass(frozen=True, slots=True, eq=False)
class Similarity:
    """From one corrected grid to another: place = scale turn(angle) place + shift_px."""

    scale: float
    angle_rad: float
    shift_px: Array

    def applied(self, points: Array) -> Array:
        """Corrected pixels (n, 2) of the other grid."""
        return np.asarray(self.scale * points @ self._turn().T + self.shift_px)

    def inverted(self, points: Array) -> Array:
        """And back."""
        return np.asarray((points - self.shift_px) @ self._turn() / self.scale)

    def view(self, view: View) -> View:
        """The same view in the other grid; a turned grid turns the source frame about z."""
        old, pose = view.intrinsics, view.source_from_guide.copy()
        centre = self.applied(np.array([[old.u0_px, old.v0_px]]))[0]
        pose[:3] = Rotation.from_euler("z", self.angle_rad).as_matrix() @ pose[:3]
        intrinsics = replace(
            old,
            alpha_x_px=old.alpha_x_px * self.scale,
            alpha_y_px=old.alpha_y_px * self.scale,
            u0_px=float(centre[0]),
            v0_px=float(centre[1]),
        )
        return View(intrinsics, pose)

    def _turn(self) -> Array:
        cosine, sine = np.cos(self.angle_rad), np.sin(self.angle_rad)
        return np.array([[cosine, -sine], [sine, cosine]])


def similarity_between(wanted: DistortionMap, other: DistortionMap) -> Similarity:
    """The similarity from the corrected grid of `other` to that of `wanted`, where a raw pixel is the same place.

    Parameters
    ----------
    wanted, other : DistortionMap
        Of two images of the same size, taken by a detector that did not move against its plate.

    Returns
    -------
    Similarity
        Least squares over the middle of the field.
    """
    side = np.linspace(-_REACH, _REACH, _SAMPLES) * wanted.half_size_px
    grid = np.column_stack([axis.ravel() for axis in np.meshgrid(side, side)])
    raw = grid[np.hypot(*grid.T) <= side[-1]] + np.array(wanted.centre_px)
    return _fitted(other.corrected_from_raw(raw), wanted.corrected_from_raw(raw))


def _fitted(start: Array, end: Array) -> Similarity:
    """The similarity nearest to point pairs (n, 2), as a complex number: end = a start + b."""
    z, w = start @ (1.0, 1.0j), end @ (1.0, 1.0j)
    z_mean, w_mean = z.mean(), w.mean()
    a = np.vdot(z - z_mean, w - w_mean) / np.vdot(z - z_mean, z - z_mean)
    b = w_mean - a * z_mean
    return Similarity(float(np.abs(a)), float(np.angle(a)), np.array([b.real, b.imag]))

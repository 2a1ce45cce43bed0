"""The shadows of round wires and balls in absorption: chords, blurred by the detector, which blurs intensity."""

import math
from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

PIXEL_VARIANCE = 1.0 / 12.0  # px^2, of the mean over a pixel
_FINENESS = 8  # samples a pixel of the tabulated profiles
_BLUR_REACH = 4.0  # standard deviations
_KEPT = 16  # profiles: those of one view, which line ends, bead and bands ask for again


@dataclass(frozen=True, slots=True, eq=False)
class Profile:
    """Absorption over the distance from a shadow's middle, 1 there: (k,) distances from 0, heights, slopes per px."""

    distance_px: Array
    height: Array
    slope_per_px: Array

    @property
    def reach_px(self) -> float:
        """Distance from which on there is nothing."""
        return float(self.distance_px[-1])

    def heights(self, distance_px: Array) -> Array:
        """Height at signed distances, of their shape."""
        return np.interp(np.abs(distance_px), self.distance_px, self.height, right=0.0)

    def slopes(self, distance_px: Array) -> Array:
        """Derivative of the height by the signed distance, per px."""
        return np.sign(distance_px) * np.interp(np.abs(distance_px), self.distance_px, self.slope_per_px, right=0.0)


@lru_cache(_KEPT)
def wire_profile(radius_px: float, depth: float, blur_px: float) -> Profile:
    """The profile across a wire.

    Parameters
    ----------
    radius_px : float
        Of the wire's shadow.
    depth : float
        Absorption at the middle of the unblurred shadow.
    blur_px : float
        Standard deviation of the detector's blur.
    """
    x = _axis(radius_px, blur_px)
    return _table(x, _blurred(np.exp(-depth * _chord(x, radius_px)), blur_px))


@lru_cache(_KEPT)
def ball_profile(radius_px: float, depth: float, blur_px: float) -> Profile:
    """The profile from the middle of a ball outwards; arguments as of `wire_profile`."""
    x, kernel = _axis(radius_px, blur_px), _kernel(blur_px)
    # of the blur across, only the row through the ball's middle is wanted; a quarter of the ball tells all
    across, down = x[len(x) // 2 :, None], np.arange(len(kernel) // 2 + 1) / _FINENESS
    passed = np.exp(-depth * _chord(np.hypot(across, down), radius_px))
    weights = kernel[len(kernel) // 2 :] * np.where(down > 0.0, 2.0, 1.0)
    row = passed @ weights
    return _table(x, _blurred(np.concatenate((row[:0:-1], row)), blur_px))


def _axis(radius_px: float, blur_px: float) -> Array:
    reach_px = radius_px + _BLUR_REACH * math.sqrt(blur_px**2 + PIXEL_VARIANCE)
    count = math.ceil(reach_px * _FINENESS)
    return np.arange(-count, count + 1) / _FINENESS


def _chord(distance_px: Array, radius_px: float) -> Array:
    return np.asarray(np.sqrt(np.clip(1.0 - (distance_px / radius_px) ** 2, 0.0, None)))


def _blurred(passed: Array, blur_px: float) -> Array:
    """Intensities (n,) on the axis as the detector blurs them, beyond their ends what is there."""
    kernel = _kernel(blur_px)
    return np.convolve(np.pad(passed, len(kernel) // 2, mode="edge"), kernel, mode="valid")


def _kernel(blur_px: float) -> Array:
    """Weights of the blur, an odd number of them."""
    sigma = math.sqrt(blur_px**2 + PIXEL_VARIANCE) * _FINENESS
    return np.asarray(cv2.getGaussianKernel(2 * round(_BLUR_REACH * sigma) + 1, sigma)[:, 0], dtype=np.float64)


def _table(x: Array, passed: Array) -> Profile:
    depth = -np.log(passed)
    height = depth / depth[len(x) // 2]
    outer = slice(len(x) // 2, None)
    return Profile(x[outer], height[outer], np.gradient(height, x)[outer])

"""Where a wire really is, seen across it: a Gaussian crest on a sloping ground fitted to each profile."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.absorption import Absorption
from vision.distortion import DistortionMap
from vision.spots import solve_patches

Array = NDArray[np.float64]

_REACH = 1.6  # half length of a profile, in wire widths
_STEP_PX = 0.5
_ROUNDS = 5
_CREST_SD = 0.35  # in wire widths: the chord through a wire, blurred


@dataclass(frozen=True, slots=True, eq=False)
class Profiles:
    """Fits across a wire.

    Attributes
    ----------
    offset_px : Array
        (n,): crest from the model's place, along the normal, corrected px.
    amplitude : Array
        (n,): absorption of the wire.
    misfit : Array
        (n,): root mean square of what the fit leaves, absorption.
    """

    offset_px: Array
    amplitude: Array
    misfit: Array


class ProfileReader:
    """Reads profiles of one image, interpolated by windowed sinc."""

    def __init__(self, absorption: Absorption, distortion: DistortionMap, wire_px: float) -> None:
        self._image = absorption.values
        self._distortion = distortion
        self.reach_px = _REACH * wire_px
        self._offsets = np.arange(-self.reach_px, self.reach_px + _STEP_PX / 2.0, _STEP_PX)
        self._crest_sd_px = _CREST_SD * wire_px

    def read(self, points: Array, normals: Array) -> Profiles:
        """Fit the crest across each place (n, 2) with unit normal (n, 2), corrected pixels."""
        return self._fit(self._values(points, normals), self._crest_sd_px)

    def amplitude_at(self, points: Array, normals: Array) -> Array:
        """Absorption (n,) of a wire whose crest is exactly at the places given."""
        design = self._design(np.zeros(len(points)), self._crest_sd_px)
        return solve_patches(design[:, :, [0, 2, 3]], self._values(points, normals))[:, 0]

    def values_at(self, points: Array) -> Array:
        """Absorption (n,) at corrected pixels (n, 2)."""
        return self._interpolated(self._distortion.raw_from_corrected(points)[:, None, :])[:, 0]

    @property
    def crest_sd_px(self) -> float:
        """Standard deviation of a wire's crest in this image."""
        return self._crest_sd_px

    def _values(self, points: Array, normals: Array) -> Array:
        """Absorption (n, p) along the normals."""
        reach = self.reach_px
        ends = self._distortion.raw_from_corrected(np.vstack((points - reach * normals, points + reach * normals)))
        start, end = ends[: len(points)], ends[len(points) :]
        share = ((self._offsets + reach) / (2.0 * reach))[None, :, None]
        raw = start[:, None, :] * (1.0 - share) + end[:, None, :] * share
        return self._interpolated(raw)

    def _interpolated(self, raw: Array) -> Array:
        """Absorption (n, p) at raw pixels (n, p, 2)."""
        u, v = raw[:, :, 0].astype(np.float32), raw[:, :, 1].astype(np.float32)
        values = cv2.remap(self._image, u, v, cv2.INTER_LANCZOS4, borderMode=cv2.BORDER_REPLICATE)
        return np.asarray(values, dtype=np.float64)

    def _fit(self, values: Array, crest_sd_px: float) -> Profiles:
        offset = np.zeros(len(values))
        for _ in range(_ROUNDS):
            design = self._design(offset, crest_sd_px)
            solved = solve_patches(design, values)
            with np.errstate(divide="ignore", invalid="ignore"):
                step = np.nan_to_num(solved[:, 1] / solved[:, 0])
            offset = np.clip(offset + np.clip(step, -1.0, 1.0), -self.reach_px, self.reach_px)
        left = values - np.einsum("npk,nk->np", design, solved)
        return Profiles(offset, solved[:, 0], np.sqrt((left**2).mean(axis=1)))

    def _design(self, offset: Array, crest_sd_px: float) -> Array:
        """Crest, its derivative by the offset, ground and slope: (n, p, 4)."""
        x = self._offsets - offset[:, None]
        crest = np.exp(-(x**2) / (2.0 * crest_sd_px**2))
        slope = np.broadcast_to(self._offsets, crest.shape)
        return np.stack((crest, crest * x / crest_sd_px**2, np.ones_like(crest), slope), axis=2)

"""Random tissue texture that stays with the patient: tiles on planes through the body, which every ray crosses."""

from dataclasses import dataclass
from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_TILE_PX = 512
_KEPT_TILES = 64  # 1 MB each: three for each of some patients


@dataclass(frozen=True, slots=True)
class Texture:
    """A periodic tile on the coronal plane y = `plane_mm` of the patient; values have mean 0 and sd 1."""

    seed: int
    plane_mm: float
    pixel_mm: float
    slope: float  # of the amplitude spectrum: 1 is cloudy, 0.5 grainy

    def sample(self, origin: Array, rays: Array32) -> Array32:
        """Value (rows, columns) where rays (rows, columns, 3) from one origin cross the plane, patient frame."""
        across = rays[..., 1]
        steep = np.where(np.abs(across) < 0.1, np.float32(0.1), across)
        along = np.float32(self.plane_mm - origin[1]) / steep
        x = (np.float32(origin[0]) + along * rays[..., 0]) / np.float32(self.pixel_mm)
        z = (np.float32(origin[2]) + along * rays[..., 2]) / np.float32(self.pixel_mm)
        sampled: Array32 = cv2.remap(
            tile(self), np.mod(x, _TILE_PX), np.mod(z, _TILE_PX), cv2.INTER_LINEAR, borderMode=cv2.BORDER_WRAP
        )
        return sampled


def tile(texture: Texture) -> Array32:
    """One period of a texture: white noise shaped to a power of frequency."""
    return _tile(texture.seed, texture.slope)


@lru_cache(maxsize=_KEPT_TILES)
def _tile(seed: int, slope: float) -> Array32:
    rng = np.random.default_rng(seed)
    spectrum = np.fft.rfft2(rng.standard_normal((_TILE_PX, _TILE_PX)))
    frequency = np.hypot(np.fft.fftfreq(_TILE_PX)[:, None], np.fft.rfftfreq(_TILE_PX)[None, :])
    shaped = np.where(frequency > 0.0, spectrum / np.maximum(frequency, 1.0 / _TILE_PX) ** slope, 0.0)
    values = np.fft.irfft2(shaped, s=(_TILE_PX, _TILE_PX))
    tile: Array32 = (values / values.std()).astype(np.float32)
    return tile

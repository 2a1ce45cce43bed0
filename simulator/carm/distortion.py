"""How an image intensifier bends the image: pincushion, S-shaped twist, shift and local waves."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_INVERSE_ROUNDS = 30  # at most: each leaves at most half of the error in the corners
_SETTLED_PX = 1e-7
_REACH = 1.7  # half sides from the centre: beyond the corners
_WAVES = 2


@dataclass(frozen=True, slots=True)
class Wave:
    """One local wave: displacement along an axis, as a plane wave over the image."""

    amplitude_px: tuple[float, float]
    cycles_per_px: tuple[float, float]
    phase_rad: float

    def height(self, u: Array, v: Array) -> Array:
        """Displacement as a share of the amplitude, at offsets from the image's centre."""
        turns = self.cycles_per_px[0] * u + self.cycles_per_px[1] * v
        height: Array = np.sin(2.0 * np.pi * turns + self.phase_rad)
        return height


@dataclass(frozen=True, slots=True)
class Distortion:
    """A smooth map from raw to ideal pixels about the image's centre.

    With n the distance from the centre in half sides: the radius shrinks by `pincushion` n^2 (raw images are
    stretched outwards), the angle turns by `twist_rad` n^2, then come a turn and a shift of the whole and the waves.
    """

    pincushion: float
    twist_rad: float
    turn_rad: float
    shift_px: tuple[float, float]
    waves: tuple[Wave, ...]
    centre_px: float = 511.5

    def ideal_from_raw(self, raw_px: Array) -> Array:
        """Ideal pixels (..., 2) of raw pixels (..., 2)."""
        u, v = raw_px[..., 0] - self.centre_px, raw_px[..., 1] - self.centre_px
        squared = (u * u + v * v) / self.centre_px**2
        angle, scale = self.twist_rad * squared + self.turn_rad, 1.0 - self.pincushion * squared
        cosine, sine = scale * np.cos(angle), scale * np.sin(angle)
        ideal = np.empty_like(raw_px, dtype=np.float64)
        ideal[..., 0] = cosine * u - sine * v + (self.centre_px + self.shift_px[0])
        ideal[..., 1] = sine * u + cosine * v + (self.centre_px + self.shift_px[1])
        for wave in self.waves:
            height = wave.height(u, v)
            ideal[..., 0] += wave.amplitude_px[0] * height
            ideal[..., 1] += wave.amplitude_px[1] * height
        return ideal

    def raw_from_ideal(self, ideal_px: Array) -> Array:
        """Raw pixels (..., 2) of ideal pixels (..., 2), by fixed-point rounds of the forward map.

        Far outside the image the map folds over: points there are left where they are, and stay outside.
        """
        raw = np.array(ideal_px, dtype=np.float64)
        near = np.hypot(raw[..., 0] - self.centre_px, raw[..., 1] - self.centre_px) < _REACH * self.centre_px
        for _ in range(_INVERSE_ROUNDS):
            move = np.where(near[..., None], ideal_px - self.ideal_from_raw(raw), 0.0)
            raw += move
            if np.abs(move).max(initial=0.0) < _SETTLED_PX:
                break
        return raw


NO_DISTORTION = Distortion(0.0, 0.0, 0.0, (0.0, 0.0), ())


def draw_distortion(rng: np.random.Generator, strength: float = 1.0) -> Distortion:
    """A distortion as one C-arm pose may give it; a strength above 1 bends more."""
    waves = tuple(_draw_wave(rng, strength) for _ in range(_WAVES))
    return Distortion(
        pincushion=strength * rng.uniform(0.018, 0.034),
        twist_rad=strength * rng.uniform(-0.022, 0.022),
        turn_rad=rng.uniform(-0.006, 0.006),
        shift_px=(rng.uniform(-4.5, 4.5), rng.uniform(-4.5, 4.5)),
        waves=waves,
    )


def _draw_wave(rng: np.random.Generator, strength: float) -> Wave:
    period_px, direction = rng.uniform(750.0, 1200.0), rng.uniform(0.0, 2.0 * np.pi)
    amplitude, along = strength * rng.uniform(0.2, 0.7), rng.uniform(0.0, 2.0 * np.pi)
    return Wave(
        amplitude_px=(amplitude * np.cos(along), amplitude * np.sin(along)),
        cycles_per_px=(np.cos(direction) / period_px, np.sin(direction) / period_px),
        phase_rad=rng.uniform(0.0, 2.0 * np.pi),
    )

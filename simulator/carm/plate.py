"""The correction plate on the intensifier: metal balls on a square lattice, at the detector."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from simulator.carm.camera import Camera

Array = NDArray[np.float64]

BALL_PER_MM = 0.50  # attenuation of the balls' metal
_BEYOND_PX = 120.0  # outside the image on the ideal grid, from where distortion may still bring a ball into it


@dataclass(frozen=True, slots=True)
class Plate:
    """Lattice on the true detector plane, before the intensifier bends it; `covered` hides the part with u below it."""

    spacing_mm: float = 15.0
    ball_diameter_mm: float = 2.0
    turn_rad: float = 0.0
    offset_mm: tuple[float, float] = (0.0, 0.0)
    covered_to_mm: float | None = None

    def depths(self, camera: Camera, ideal_px: Array) -> Array:
        """Optical depth (...) of the balls at ideal pixels (..., 2).

        The beam crosses a ball of 2 mm at the detector almost straight, so the chord is that of a parallel beam.
        """
        on_detector = camera.detector_mm(ideal_px)
        squared = self._from_ball_squared(on_detector)
        chord = 2.0 * np.sqrt(np.maximum((self.ball_diameter_mm / 2.0) ** 2 - squared, 0.0))
        if self.covered_to_mm is not None:
            chord = np.where(on_detector[..., 0] < self.covered_to_mm, 0.0, chord)
        depths: Array = BALL_PER_MM * chord
        return depths

    def balls_ideal_px(self, camera: Camera) -> Array:
        """Middles (n, 2) of all balls that the detector could see, ideal pixels."""
        reach = camera.pixel_mm * float(np.hypot(camera.rows, camera.columns)) / self.spacing_mm
        steps = np.arange(-np.ceil(reach), np.ceil(reach) + 1.0) * self.spacing_mm
        x, y = np.meshgrid(steps, steps)
        c, s = np.cos(self.turn_rad), np.sin(self.turn_rad)
        on_detector = np.stack([c * x - s * y, s * x + c * y], axis=-1).reshape(-1, 2) + self.offset_mm
        ideal = on_detector / camera.pixel_mm + (camera.principal_u_px, camera.principal_v_px)
        return ideal[np.all((ideal > 0.0 - _BEYOND_PX) & (ideal < (camera.columns + _BEYOND_PX)), axis=-1)]

    def _from_ball_squared(self, on_detector_mm: Array) -> Array:
        """Squared distance (...) from the nearest ball's middle, mm^2."""
        c, s = np.cos(self.turn_rad) / self.spacing_mm, np.sin(self.turn_rad) / self.spacing_mm
        x, y = on_detector_mm[..., 0] - self.offset_mm[0], on_detector_mm[..., 1] - self.offset_mm[1]
        along, across = c * x + s * y, c * y - s * x
        along, across = along - np.rint(along), across - np.rint(across)
        squared: Array = (along * along + across * across) * self.spacing_mm**2
        return squared


def draw_plate(rng: np.random.Generator) -> Plate:
    """A plate as somebody clipped it on: a little turned, a lattice point anywhere."""
    return Plate(
        turn_rad=rng.uniform(-0.05, 0.05),
        offset_mm=(rng.uniform(-7.5, 7.5), rng.uniform(-7.5, 7.5)),
    )

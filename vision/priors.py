"""What the device files say beforehand about a view and the guide's dimensions."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.devices import CArm, Guide
from vision.projection import Intrinsics, View

Array = NDArray[np.float64]

SQUARE_SD = 1.5e-4  # relative: alpha_y against alpha_x; plates and panels are square to 0.03 mm over 200 mm
VIEW_PARAMETERS = 10  # alpha_x, alpha_y, u0, v0 (px), rotation vector (rad), translation (mm): see Registration
PARAMETERS = 13  # then small radius, big radius, separation (mm)


@dataclass(frozen=True, slots=True, eq=False)
class Priors:
    """Means and standard deviations of what the files say."""

    nominal: Intrinsics
    alpha_sd_px: float
    centre_sd_px: float
    guide: Guide

    @classmethod
    def of(cls, carm: CArm, guide: Guide, nominal: Intrinsics) -> "Priors":
        """From the device files."""
        relative = carm.source_to_image_sd_mm / carm.source_to_image_mm
        return cls(nominal, nominal.alpha_x_px * relative, carm.principal_point_sd_px, guide)

    def pulls(self, view: View, guide: Guide) -> dict[str, float]:
        """How many standard deviations each quantity lies from its prior."""
        intrinsics, sd = view.intrinsics, self.guide.tolerance
        return {
            "source_to_image": (intrinsics.alpha_x_px - self.nominal.alpha_x_px) / self.alpha_sd_px,
            "square": (intrinsics.alpha_y_px - intrinsics.alpha_x_px) / (SQUARE_SD * self.nominal.alpha_x_px),
            "centre_u": (intrinsics.u0_px - self.nominal.u0_px) / self.centre_sd_px,
            "centre_v": (intrinsics.v0_px - self.nominal.v0_px) / self.centre_sd_px,
            "small_radius": (guide.small_ring_radius_mm - self.guide.small_ring_radius_mm) / sd.radius_sd_mm,
            "big_radius": (guide.big_ring_radius_mm - self.guide.big_ring_radius_mm) / sd.radius_sd_mm,
            "separation": (guide.separation_mm - self.guide.separation_mm) / sd.separation_sd_mm,
        }

    def rows(self) -> Array:
        """Derivative (7, 13) of the pulls by the 13 parameters: alphas and centre (px), pose, dimensions (mm)."""
        sd, rows = self.guide.tolerance, np.zeros((7, PARAMETERS))
        rows[0, 0] = 1.0 / self.alpha_sd_px
        rows[1, :2] = np.array([-1.0, 1.0]) / (SQUARE_SD * self.nominal.alpha_x_px)
        rows[[2, 3], [2, 3]] = 1.0 / self.centre_sd_px
        rows[[4, 5, 6], [10, 11, 12]] = 1.0 / np.array([sd.radius_sd_mm, sd.radius_sd_mm, sd.separation_sd_mm])
        return rows

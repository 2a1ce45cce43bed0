"""Drawing the room's hidden errors: their sizes are the truth's, their directions and signs the seed's."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simulator.carm.guide import GuideShape
from simulator.controller import ArmTruth
from simulator.frames import direction, displacement
from simulator.truth import Truth

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Planted:
    """What the truth means for this room."""

    shape: GuideShape
    flange_from_guide: Array  # 4x4, mm
    source_to_image_mm: float
    principal_offset_px: tuple[float, float]
    angle_error_rad: Array  # (3,), rotation vector in room axes
    cart_settling: Array  # (3,), mm in room axes


def plant(truth: Truth, shape: GuideShape, flange_from_guide: Array, nominal_source_to_image_mm: float) -> Planted:
    """Draw every error of a room once."""
    rng = np.random.default_rng(truth.seed)
    principal = rng.uniform(0.0, 2.0 * np.pi)
    cart = rng.uniform(0.0, 2.0 * np.pi)
    offset_px = truth.carm.principal_point_error_px
    return Planted(
        shape=_made(shape, truth, rng),
        flange_from_guide=flange_from_guide
        @ displacement(
            truth.tool.translation_error_mm * direction(rng),
            np.deg2rad(truth.tool.rotation_error_deg) * direction(rng),
        ),
        source_to_image_mm=nominal_source_to_image_mm + truth.carm.source_to_image_error_mm * _sign(rng),
        principal_offset_px=(offset_px * np.cos(principal), offset_px * np.sin(principal)),
        angle_error_rad=np.deg2rad(truth.carm.angle_error_deg) * direction(rng),
        cart_settling=truth.cart.settling_mm * np.array([np.cos(cart), np.sin(cart), 0.0]),
    )


def arm_truth(truth: Truth) -> ArmTruth:
    """The errors that the controller hides."""
    return ArmTruth(
        kinematic_error_mm=truth.arm.kinematic_error_mm,
        repeatability_mm=truth.arm.repeatability_mm,
        seed=truth.seed,
    )


def _made(shape: GuideShape, truth: Truth, rng: np.random.Generator) -> GuideShape:
    """The guide as it came from the workshop."""
    ring, aside = truth.guide.ring_error_mm, rng.uniform(0.0, 2.0 * np.pi)
    bead = np.array(shape.bead_mm) + truth.guide.bead_error_mm * direction(rng)
    bore = truth.guide.concentricity_error_mm
    return replace(
        shape,
        small_radius_mm=shape.small_radius_mm + ring * _sign(rng),
        big_radius_mm=shape.big_radius_mm + ring * _sign(rng),
        separation_mm=shape.separation_mm + ring * _sign(rng),
        bead_mm=(float(bead[0]), float(bead[1]), float(bead[2])),
        big_centre_mm=(bore * np.cos(aside), bore * np.sin(aside)),
    )


def _sign(rng: np.random.Generator) -> float:
    return float(rng.choice((-1.0, 1.0)))

"""What stands before the detector at one exposure, and what a test may make wrong with it."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from simulator.carm.anatomy import Anatomy
from simulator.carm.camera import Camera
from simulator.carm.distortion import NO_DISTORTION, Distortion
from simulator.carm.guide import GuideShape
from simulator.carm.plate import Plate

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PlacedGuide:
    """A guide, or something that looks like one, and where it is (4x4, mm)."""

    shape: GuideShape
    source_from_guide: Array


@dataclass(frozen=True, slots=True)
class Exposure:
    """How the image is taken and shown."""

    photons: float = 15000.0  # quanta a pixel where the image is white: the dose
    gamma: float = 0.8  # of the display
    blur_px: float = 1.1  # sd of the point spread
    bits: int = 8
    gain: float = 1.0  # above 1 the bright parts saturate
    motion_px: float = 0.0  # length of a straight motion during the exposure
    motion_rad: float = 0.0  # its direction from +u to +v
    collimator_px: tuple[float, float, float, float] | None = (
        None  # raw u and v of the blades: left, right, top, bottom
    )
    crop_px: tuple[int, int, int, int] | None = None  # first column, last, first row, last of what is handed out


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """Everything that an image depends on, except the noise."""

    camera: Camera
    guides: tuple[PlacedGuide, ...]  # the first is the one whose truth is told
    target_ideal_px: tuple[float, float]
    distortion: Distortion = NO_DISTORTION
    plate: Plate | None = None
    intensifier: bool = True  # a round field of view; a flat panel shows all
    body: Anatomy | None = None
    source_from_patient: Array = field(default_factory=lambda: np.eye(4))
    exposure: Exposure = Exposure()
    name: str = "scene"
    group: str = "ii"

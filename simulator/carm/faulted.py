"""Scenes with one thing wrong each: what a registration has to get right or refuse."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.carm.drawing import Group, random_scene
from simulator.carm.guide import ALL_PARTS, GuideShape, Part
from simulator.carm.scene import Exposure, PlacedGuide, Scene

Array = NDArray[np.float64]
Pixels = NDArray[np.uint8] | NDArray[np.uint16]

PATIENTS = 16  # bodies in turn: their textures are kept from scene to scene


class Fault(StrEnum):
    """What is wrong with a scene."""

    NOTHING = "nothing"
    MIRRORED = "mirrored"
    CROPPED = "cropped"
    ZOOMED = "zoomed"  # another field than the C-arm's file says
    SMALL_RING_HIDDEN = "small_ring_hidden"
    BIG_RING_HIDDEN = "big_ring_hidden"
    LINE_HIDDEN = "line_hidden"
    BEAD_HIDDEN = "bead_hidden"
    DECOY_RINGS = "decoy_rings"
    INSTRUMENTS = "instruments"
    SMALL_RADIUS = "small_radius"  # this and the next eight: off by 3 to 10 % from the guide's file
    BIG_RADIUS = "big_radius"
    SEPARATION = "separation"
    LINE_START = "line_start"
    LINE_END = "line_end"
    WIRE_DIAMETER = "wire_diameter"
    BEAD_Y = "bead_y"
    BEAD_Z = "bead_z"
    BEAD_DIAMETER = "bead_diameter"
    NO_PLATE = "no_plate"
    PLATE_COVERED = "plate_covered"
    FLAT_PANEL_FILE = "flat_panel_file"  # an intensifier's image, taken for a flat panel's
    MOTION_BLUR = "motion_blur"
    LOW_DOSE = "low_dose"
    SATURATION = "saturation"
    COLLIMATED = "collimated"
    SECOND_GUIDE = "second_guide"


_WITH_PLATE = (Group.INTENSIFIER, Group.STEEP, Group.STRONG)
_NEEDS_PLATE = (Fault.NO_PLATE, Fault.PLATE_COVERED, Fault.FLAT_PANEL_FILE)


@dataclass(frozen=True, slots=True, eq=False)
class FaultedScene:
    """A scene, as whose image it is taken, and what happens to its pixels on the way."""

    scene: Scene
    intensifier_file: bool
    flip: Callable[[Pixels], Pixels] | None = None  # a flipped image tells no target: any acceptance is wrong


_FLIPS: tuple[Callable[[Pixels], Pixels], ...] = (
    np.fliplr,
    np.flipud,
    np.transpose,
    lambda pixels: np.rot90(pixels, 2).T,
)


def faulted_scene(fault: Fault, seed: int) -> FaultedScene:
    """A random scene with a fault of random size; the same seed gives the same."""
    rng = np.random.default_rng([list(Fault).index(fault), seed])
    groups = _WITH_PLATE if fault in _NEEDS_PLATE else tuple(Group)
    scene = random_scene(int(rng.integers(2**31)), groups[int(rng.integers(len(groups)))], seed % PATIENTS)
    if fault is Fault.MIRRORED:
        return FaultedScene(scene, scene.intensifier, _FLIPS[int(rng.integers(len(_FLIPS)))])
    spoilt = _SPOILT[fault](scene, rng) if fault in _SPOILT else scene
    return FaultedScene(spoilt, scene.intensifier and fault is not Fault.FLAT_PANEL_FILE)


def _without(part: Part) -> "Spoiling":
    def spoil(scene: Scene, _: np.random.Generator) -> Scene:
        return _reshaped(scene, parts=ALL_PARTS - {part})

    return spoil


def _misshapen(name: str) -> "Spoiling":
    def spoil(scene: Scene, rng: np.random.Generator) -> Scene:
        return _reshaped(scene, **{name: getattr(scene.guides[0].shape, name) * _off(rng, 0.03, 0.10)})

    return spoil


def _misplaced_bead(axis: int) -> "Spoiling":
    def spoil(scene: Scene, rng: np.random.Generator) -> Scene:
        place = list(scene.guides[0].shape.bead_mm)
        place[axis] *= _off(rng, 0.03, 0.10)
        return _reshaped(scene, bead_mm=tuple(place))

    return spoil


def _off(rng: np.random.Generator, least: float, most: float) -> float:
    """A factor off 1 by a share in these limits, either way."""
    return 1.0 + float(rng.choice((-1.0, 1.0)) * rng.uniform(least, most))


def _reshaped(scene: Scene, **changes: object) -> Scene:
    guide, *others = scene.guides
    shape = replace(guide.shape, **changes)  # type: ignore[arg-type]  # names come from this module alone
    return replace(scene, guides=(PlacedGuide(shape, guide.source_from_guide), *others))


def _exposed(scene: Scene, **changes: object) -> Scene:
    exposure: Exposure = replace(scene.exposure, **changes)  # type: ignore[arg-type]  # as above
    return replace(scene, exposure=exposure)


def _cropped(scene: Scene, rng: np.random.Generator) -> Scene:
    """One to four edges cut off, up to a third of the image each."""
    cut = rng.integers(8, 340, 4) * (rng.permutation(4) < rng.integers(1, 5))
    left, right, top, bottom = (int(edge) for edge in cut)
    return _exposed(scene, crop_px=(left, scene.camera.columns - 1 - right, top, scene.camera.rows - 1 - bottom))


def _zoomed(scene: Scene, rng: np.random.Generator) -> Scene:
    """Another field about the image's middle: the bent image of an intensifier is enlarged with its bends."""
    camera, factor = scene.camera, _off(rng, 0.03, 0.25)
    middle_u, middle_v = (camera.columns - 1) / 2.0, (camera.rows - 1) / 2.0
    return replace(
        scene,
        camera=replace(
            camera,
            pixel_mm=camera.pixel_mm / factor,
            principal_u_px=middle_u + factor * (camera.principal_u_px - middle_u),
            principal_v_px=middle_v + factor * (camera.principal_v_px - middle_v),
        ),
    )


def _with_decoy_rings(scene: Scene, rng: np.random.Generator) -> Scene:
    """One to three rings of other sizes, at other heights and leanings, some about the guide's own axis."""
    rings = tuple(_decoy_ring(scene, rng) for _ in range(rng.integers(1, 4)))
    return replace(scene, guides=(*scene.guides, *rings))


def _decoy_ring(scene: Scene, rng: np.random.Generator) -> PlacedGuide:
    shape = GuideShape(
        small_radius_mm=rng.uniform(12.0, 40.0),
        wire_diameter_mm=rng.uniform(0.8, 2.0),
        parts=frozenset({Part.SMALL_RING}),
    )
    along = np.array([0.0, 0.0, rng.uniform(-70.0, 20.0)])
    coaxial = rng.uniform() < 0.5
    return PlacedGuide(shape, _beside(scene, rng, along, 0.0 if coaxial else 40.0, 0.0 if coaxial else 0.5))


def _with_instruments(scene: Scene, rng: np.random.Generator) -> Scene:
    """One to four rods or needles across the field."""
    rods = tuple(_rod(scene, rng) for _ in range(rng.integers(1, 5)))
    return replace(scene, guides=(*scene.guides, *rods))


def _rod(scene: Scene, rng: np.random.Generator) -> PlacedGuide:
    length_mm = rng.uniform(30.0, 200.0)
    shape = GuideShape(
        line_start_mm=-length_mm / 2.0,
        line_end_mm=length_mm / 2.0,
        wire_diameter_mm=rng.uniform(0.8, 5.0),
        parts=frozenset({Part.LINE}),
    )
    return PlacedGuide(shape, _beside(scene, rng, np.array([0.0, 0.0, rng.uniform(-150.0, 40.0)]), 60.0, 0.5))


def _beside(scene: Scene, rng: np.random.Generator, offset_mm: Array, apart_mm: float, lean_rad: float) -> Array:
    """A pose (4x4) relative to the guide's: at an offset, up to `apart_mm` across, leaning by about `lean_rad`."""
    guide_from_thing = np.eye(4)
    lean = Rotation.from_rotvec(rng.normal(0.0, lean_rad, 3) * (1.0, 1.0, 0.0))
    guide_from_thing[:3, :3] = (lean * Rotation.from_euler("z", rng.uniform(0.0, 2.0 * np.pi))).as_matrix()
    guide_from_thing[:3, 3] = offset_mm + rng.uniform(-apart_mm, apart_mm, 3) * (1.0, 1.0, 0.0)
    pose: Array = scene.guides[0].source_from_guide @ guide_from_thing
    return pose


def _with_second_guide(scene: Scene, rng: np.random.Generator) -> Scene:
    """Another guide of the same make beside the first, whole or partly out of the field."""
    pose = _beside(scene, rng, np.array([0.0, 0.0, rng.uniform(-60.0, 60.0)]), 110.0, 0.2)
    return replace(scene, guides=(*scene.guides, PlacedGuide(GuideShape(), pose)))


def _with_covered_plate(scene: Scene, rng: np.random.Generator) -> Scene:
    plate = scene.plate and replace(scene.plate, covered_to_mm=rng.uniform(-170.0, 170.0))
    return replace(scene, plate=plate)


def _collimated(scene: Scene, rng: np.random.Generator) -> Scene:
    """Blades from each side, up to the image's middle but for a hand's breadth."""
    left, top = rng.uniform(0.0, 400.0, 2)
    right, bottom = 1023.0 - rng.uniform(0.0, 400.0, 2)
    return _exposed(scene, collimator_px=(left, right, top, bottom))


def _smeared(scene: Scene, rng: np.random.Generator) -> Scene:
    return _exposed(scene, motion_px=rng.uniform(2.0, 25.0), motion_rad=rng.uniform(0.0, np.pi))


def _underexposed(scene: Scene, rng: np.random.Generator) -> Scene:
    return _exposed(scene, photons=float(np.exp(rng.uniform(np.log(30.0), np.log(3000.0)))))


def _saturated(scene: Scene, rng: np.random.Generator) -> Scene:
    return _exposed(scene, gain=rng.uniform(1.2, 4.0))


Spoiling = Callable[[Scene, np.random.Generator], Scene]

_SPOILT: dict[Fault, Spoiling] = {
    Fault.CROPPED: _cropped,
    Fault.ZOOMED: _zoomed,
    Fault.SMALL_RING_HIDDEN: _without(Part.SMALL_RING),
    Fault.BIG_RING_HIDDEN: _without(Part.BIG_RING),
    Fault.LINE_HIDDEN: _without(Part.LINE),
    Fault.BEAD_HIDDEN: _without(Part.BEAD),
    Fault.DECOY_RINGS: _with_decoy_rings,
    Fault.INSTRUMENTS: _with_instruments,
    Fault.SMALL_RADIUS: _misshapen("small_radius_mm"),
    Fault.BIG_RADIUS: _misshapen("big_radius_mm"),
    Fault.SEPARATION: _misshapen("separation_mm"),
    Fault.LINE_START: _misshapen("line_start_mm"),
    Fault.LINE_END: _misshapen("line_end_mm"),
    Fault.WIRE_DIAMETER: _misshapen("wire_diameter_mm"),
    Fault.BEAD_Y: _misplaced_bead(1),
    Fault.BEAD_Z: _misplaced_bead(2),
    Fault.BEAD_DIAMETER: _misshapen("bead_diameter_mm"),
    Fault.NO_PLATE: lambda scene, _: replace(scene, plate=None),
    Fault.PLATE_COVERED: _with_covered_plate,
    Fault.MOTION_BLUR: _smeared,
    Fault.LOW_DOSE: _underexposed,
    Fault.SATURATION: _saturated,
    Fault.COLLIMATED: _collimated,
    Fault.SECOND_GUIDE: _with_second_guide,
}

"""A patient lying prone: lumbar spine, soft tissue, table, and the pedicles with the paths planned through them."""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.carm.anatomy import Anatomy, Body
from simulator.carm.solids import Shape, Solid
from simulator.carm.texture import Texture
from simulator.frames import ROOM_FROM_PATIENT
from simulator.pedicle import Pedicle
from simulator.spine import LEVELS, Level, pedicle_axis, pedicle_middle, vertebra

Array = NDArray[np.float64]

_SKIN_Y_MM = 79.0  # of the back over the lumbar spine
MIDDLE_OF_TARGETS_MM = (0.0, 22.9, 6.4)  # of the ten planned here, for which the arm's place was searched
_TARGET_PAST_MIDDLE_MM = 4.0  # the planned target lies this far beyond the pedicle's narrowest place
_TISSUE_PER_MM = 0.019
_GAS_PER_MM = -0.42 * _TISSUE_PER_MM  # bubbles overlap
_BOWEL_LOOPS, _BUBBLES_A_LOOP = 6, 5


@dataclass(frozen=True, slots=True, eq=False)
class Patient:
    """Anatomy and plan, patient frame (LPS), and how the patient lies in the room (4x4, mm)."""

    body: Anatomy
    pedicles: dict[str, Pedicle]
    room_from_patient: Array


@lru_cache(maxsize=32)
def build_patient(seed: int) -> Patient:
    """A patient whose origin is the middle of L3's body; the seed draws bowel gas and texture, not the spine."""
    sides = (("left", 1.0), ("right", -1.0))
    planned = [_plan(level, name, side) for level in LEVELS for name, side in sides]
    return Patient(build_body(seed), {pedicle.name: pedicle for pedicle in planned}, ROOM_FROM_PATIENT)


def build_body(seed: int) -> Body:
    """The body of that patient."""
    bone = tuple(solid for level in LEVELS for solid in vertebra(level)) + _pelvis()
    return Body(
        bone=bone,
        soft=(*_tissue(), *_gas(np.random.default_rng(seed))),
        bone_textures=((Texture(seed, 5.0, 0.5, 0.7), 0.10),),
        soft_textures=(
            (Texture(seed + 1, -70.0, 0.9, 1.5), 0.16),
            (Texture(seed + 2, 50.0, 0.6, 1.1), 0.05),
        ),
    )


def _plan(level: Level, name: str, side: float) -> Pedicle:
    middle, axis = pedicle_middle(level, side), pedicle_axis(level, side)
    entry = middle + axis * (_SKIN_Y_MM - middle[1]) / axis[1]
    return Pedicle(f"{level.name}-{name}", entry, middle - _TARGET_PAST_MIDDLE_MM * axis)


def _pelvis() -> tuple[Solid, ...]:
    """Iliac crests and the upper end of the sacrum."""
    crests = tuple(
        Solid(Shape.ELLIPSOID, (side * 88.0, 30.0, -118.0), (38.0, 13.0, 52.0), 0.020) for side in (-1.0, 1.0)
    )
    return (*crests, Solid(Shape.ELLIPSOID, (0.0, 28.0, -112.0), (44.0, 24.0, 28.0), 0.018))


def _tissue() -> tuple[Solid, ...]:
    """Trunk, psoas and back muscles, kidneys, and the table under the belly."""
    paired = [
        ((46.0, 2.0, -20.0), (21.0, 20.0, 125.0), 0.0045),  # psoas
        ((33.0, 52.0, 0.0), (26.0, 20.0, 260.0), 0.0030),  # erector spinae
        ((62.0, 10.0, 55.0), (27.0, 24.0, 52.0), 0.0030),  # kidney
    ]
    muscles = [
        Solid(Shape.ELLIPSOID, (side * x, y, z), half, per_mm)
        for (x, y, z), half, per_mm in paired
        for side in (-1.0, 1.0)
    ]
    trunk = Solid(Shape.CYLINDER, (0.0, -22.0, 0.0), (170.0, 102.0, 400.0), _TISSUE_PER_MM)
    table = Solid(Shape.BOX, (0.0, -140.0, 0.0), (260.0, 15.0, 1000.0), 0.004)
    return (trunk, *muscles, table)


def _gas(rng: np.random.Generator) -> tuple[Solid, ...]:
    """Bowel gas in loops of bubbles: the bright clouds beside a lumbar spine."""
    return tuple(bubble for _ in range(_BOWEL_LOOPS) for bubble in _loop(rng))


def _loop(rng: np.random.Generator) -> list[Solid]:
    """Overlapping bubbles along a random walk."""
    place = np.array(
        [rng.choice((-1.0, 1.0)) * rng.uniform(45.0, 115.0), rng.uniform(-85.0, -55.0), rng.uniform(-110.0, 110.0)]
    )
    bubbles = []
    for _ in range(_BUBBLES_A_LOOP):
        place = place + rng.normal(0.0, (11.0, 5.0, 13.0))
        x, y, z = (float(coordinate) for coordinate in place)
        half = (rng.uniform(7.0, 22.0), rng.uniform(7.0, 18.0), rng.uniform(7.0, 24.0))
        turn = Rotation.random(rng=rng).as_matrix()
        bubbles.append(Solid(Shape.ELLIPSOID, (x, y, z), half, _GAS_PER_MM, turn))
    return bubbles

"""Five lumbar vertebrae from simple solids: sizes of an adult, lordosis, and the axis of every pedicle."""

from dataclasses import dataclass
from math import cos, radians, sin

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.carm.solids import Shape, Solid

Array = NDArray[np.float64]
Triple = tuple[float, float, float]

# Attenuation above that of the soft tissue around, at a diagnostic spectrum's mean energy.
_CORTEX_PER_MM = 0.046
_CANCELLOUS_PER_MM = 0.016
_END_PLATE_PER_MM = 0.016  # lenses: real end plates are dished, and never seen as one sharp line
_SHELL_MM = 1.3


@dataclass(frozen=True, slots=True)
class Level:
    """Where a vertebra is and how it is built; mm and rad, patient frame (LPS), L3's body in the origin."""

    name: str
    centre_mm: Triple
    lean_rad: float  # of its upward axis, forwards positive
    body_half_mm: Triple
    pedicle_x_mm: float
    convergence_rad: float  # of the pedicle's axis towards the midline, going forwards
    pedicle_half_width_mm: float

    @property
    def patient_from_vertebra(self) -> Array:
        """Rotation of the vertebra's own axes: x left, y backwards, z up."""
        rotation: Array = Rotation.from_euler("x", self.lean_rad).as_matrix()
        return rotation

    def in_patient(self, point: Triple | Array) -> Array:
        """A point of the vertebra's frame in the patient's."""
        moved: Array = np.array(self.centre_mm) + self.patient_from_vertebra @ np.asarray(point)
        return moved


LEVELS = (
    Level("L1", (0.0, 8.0, 71.0), radians(-10.0), (21.0, 15.5, 13.0), 12.0, radians(6.0), 3.8),
    Level("L2", (0.0, 2.0, 36.0), radians(-5.0), (22.0, 16.5, 13.5), 13.0, radians(8.0), 4.2),
    Level("L3", (0.0, 0.0, 0.0), 0.0, (23.5, 17.0, 14.0), 14.5, radians(11.0), 4.8),
    Level("L4", (0.0, 2.0, -36.5), radians(6.0), (24.5, 17.5, 14.0), 16.0, radians(14.0), 5.4),
    Level("L5", (0.0, 9.0, -71.0), radians(17.0), (25.5, 17.5, 13.5), 19.0, radians(20.0), 6.5),
)

_PEDICLE_Y_MM, _PEDICLE_Z_MM = 23.0, 6.0  # of its middle, in the vertebra's frame
_PEDICLE_HALF_LENGTH_MM, _PEDICLE_HALF_HEIGHT_MM = 9.0, 7.5


def pedicle_middle(level: Level, side: float) -> Array:
    """The narrowest place of a pedicle, patient frame; side +1 is the patient's left."""
    return level.in_patient((side * level.pedicle_x_mm, _PEDICLE_Y_MM, _PEDICLE_Z_MM))


def pedicle_axis(level: Level, side: float) -> Array:
    """Unit direction along a pedicle from the body outwards: backwards and to its side, patient frame."""
    turn = level.convergence_rad
    axis: Array = level.patient_from_vertebra @ np.array([side * sin(turn), cos(turn), 0.0])
    return axis


def vertebra(level: Level) -> tuple[Solid, ...]:
    """All solids of one vertebra."""
    x, y, z = level.body_half_mm
    solids = [*_hollow(level, Shape.CYLINDER, (0.0, 0.0, 0.0), (x, y, z), np.eye(3))]
    for end in (-1.0, 1.0):
        solids.append(_solid(level, Shape.ELLIPSOID, (0.0, 0.0, end * z), (x + 2.0, y + 2.0, 2.2), _END_PLATE_PER_MM))
    for side in (-1.0, 1.0):
        solids += _side(level, side)
    return (*solids, *_hollow(level, Shape.ELLIPSOID, (0.0, 53.0, -9.0), (4.0, 15.0, 11.5), np.eye(3)))


def _side(level: Level, side: float) -> list[Solid]:
    """Pedicle, processes, facets and half a lamina."""
    width, turn = level.pedicle_half_width_mm, side * level.convergence_rad
    x = level.pedicle_x_mm
    along = Rotation.from_euler("ZX", (-turn, -np.pi / 2.0)).as_matrix()  # the cylinder's z along the pedicle
    pedicle = (width, _PEDICLE_HALF_HEIGHT_MM, _PEDICLE_HALF_LENGTH_MM)
    lamina = Rotation.from_euler("z", -side * 0.6).as_matrix()
    return [
        *_hollow(level, Shape.CYLINDER, (side * x, _PEDICLE_Y_MM, _PEDICLE_Z_MM), pedicle, along),
        _solid(level, Shape.ELLIPSOID, (side * (x + 19.0), 29.0, 4.0), (17.0, 3.6, 5.5), 0.022),
        _solid(level, Shape.ELLIPSOID, (side * (x + 3.5), 36.0, 14.0), (4.5, 6.5, 9.0), 0.026),
        _solid(level, Shape.ELLIPSOID, (side * (x - 1.5), 41.0, -16.0), (5.5, 5.0, 9.5), 0.026),
        _solid(level, Shape.ELLIPSOID, (side * 9.0, 38.0, -4.0), (9.0, 3.5, 11.0), 0.024, lamina),
    ]


def _hollow(level: Level, shape: Shape, centre: Triple, half: Triple, turn: Array) -> tuple[Solid, Solid]:
    """A shell of cortical bone with cancellous bone in it."""
    inner = (half[0] - _SHELL_MM, half[1] - _SHELL_MM, half[2] - _SHELL_MM)
    return (
        _solid(level, shape, centre, half, _CORTEX_PER_MM, turn),
        _solid(level, shape, centre, inner, _CANCELLOUS_PER_MM - _CORTEX_PER_MM, turn),
    )


def _solid(level: Level, shape: Shape, centre: Triple, half: Triple, per_mm: float, turn: Array | None = None) -> Solid:
    x, y, z = level.in_patient(centre)
    rotation = level.patient_from_vertebra @ (np.eye(3) if turn is None else turn)
    return Solid(shape, (float(x), float(y), float(z)), half, per_mm, rotation)

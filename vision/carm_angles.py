"""The C-arm's angles in which a path planned in CT projects to a point."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from vision.refusal import Refusal

Array = NDArray[np.float64]


class Position(StrEnum):
    """How the patient lies on the table."""

    PRONE = "prone"
    SUPINE = "supine"


@dataclass(frozen=True, slots=True)
class CArmAngles:
    """DICOM positioner angles (patient-based), the dial's angles from detector-up, and a mobile C-arm's two joints."""

    primary_rad: float
    secondary_rad: float
    dial_primary_rad: float
    dial_secondary_rad: float
    orbital_rad: float
    tilt_rad: float
    rotation_from_vertical_rad: float
    words: str


def carm_angles(entry_in_patient: Array, target_in_patient: Array, position: Position) -> CArmAngles | Refusal:
    """Angles in which the beam runs along the path from entry to target, both (3,), LPS mm."""
    raise NotImplementedError

"""How the C-arm stands: from the positioner angles on its dials to the pose of source and detector in the room."""

from dataclasses import dataclass
from math import asin, atan2, cos, radians, sin

import numpy as np
from numpy.typing import NDArray

from simulator.frames import ROOM_FROM_PATIENT

Array = NDArray[np.float64]

SOURCE_TO_ISOCENTRE_MM = 610.0
_LARGEST_TILT_RAD = radians(60.0)  # of the detector from straight up, under which the C-arm does not hit the table


@dataclass(frozen=True, slots=True)
class Angles:
    """Positioner angles, DICOM patient-based, rad: 180 deg primary is a detector behind the patient."""

    primary_rad: float
    secondary_rad: float

    def __post_init__(self) -> None:
        """ValueError on angles that the C-arm cannot reach with a table in the way."""
        tilt = np.arccos(np.clip(self.beam_in_room[2], -1.0, 1.0))
        if not np.isfinite(tilt) or tilt > _LARGEST_TILT_RAD:
            raise ValueError("the C-arm would hit the table at these angles: the detector must be above the patient")

    @property
    def beam_in_patient(self) -> Array:
        """Unit direction from source to detector, patient frame (PS3.3 C.8.7.5)."""
        a, b = self.primary_rad, self.secondary_rad
        return np.array([sin(a) * cos(b), -cos(a) * cos(b), sin(b)])

    @property
    def beam_in_room(self) -> Array:
        """Unit direction from source to detector, room frame."""
        beam: Array = ROOM_FROM_PATIENT[:3, :3] @ self.beam_in_patient
        return beam

    @property
    def from_vertical_rad(self) -> tuple[float, float]:
        """What the dials show for a prone patient, counted from the detector straight up."""
        x, y, z = self.beam_in_patient
        return atan2(-x, y), asin(z)


def angles_of(entry_in_patient: Array, target_in_patient: Array) -> Angles:
    """The angles whose beam runs along a planned path, from target to entry."""
    x, y, z = (entry_in_patient - target_in_patient) / np.linalg.norm(entry_in_patient - target_in_patient)
    return Angles(atan2(x, -y), asin(z))


def room_from_source(beam_in_room: Array, isocentre_in_room: Array) -> Array:
    """Pose of the source frame (4x4, mm): z along the beam, the image's top towards the patient's head."""
    down = np.array([-1.0, 0.0, 0.0])
    v = down - beam_in_room * (down @ beam_in_room)
    v = v / np.linalg.norm(v)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([np.cross(v, beam_in_room), v, beam_in_room])
    pose[:3, 3] = isocentre_in_room - SOURCE_TO_ISOCENTRE_MM * beam_in_room
    return pose


def sag_in_room(angles: Angles, sag_mm: float) -> Array:
    """How far the isocentre sinks and sways (3,), depending on where the heavy ends are."""
    orbital, tilt = angles.from_vertical_rad
    return sag_mm * np.array([sin(tilt), sin(orbital), -cos(orbital) * cos(tilt)])


def sag_on_detector_mm(angles: Angles, sag_mm: float) -> tuple[float, float]:
    """How far the detector sways against the source along u and v."""
    orbital, tilt = angles.from_vertical_rad
    return sag_mm * sin(orbital), sag_mm * sin(tilt)

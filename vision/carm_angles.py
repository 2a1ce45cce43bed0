"""The C-arm's angles in which a path planned in CT projects to a point: the beam runs along the path."""

import math
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from vision.refusal import Refusal, RefusalCode

Array = NDArray[np.float64]

# A path in metres instead of millimetres falls outside, either way round (H09).
_LEAST_PATH_MM = 2.0
_GREATEST_PATH_MM = 1000.0
_LEAST_ACROSS = 0.02  # sine of the path's angle to the body's long axis, where the primary angle has no meaning


class Position(StrEnum):
    """How the patient lies on the table."""

    PRONE = "prone"
    SUPINE = "supine"


@dataclass(frozen=True, slots=True)
class CArmAngles:
    """One direction of the beam, as three kinds of C-arm state it.

    Attributes
    ----------
    primary_rad, secondary_rad : float
        DICOM positioner angles, patient-based (PS3.3 C.8.7.5).
    rotation_from_vertical_rad, angulation_from_vertical_rad : float
        The same on the dial: equipment-based, from the detector straight above the patient.
    orbital_rad, tilt_rad : float
        For a mobile C-arm at the table's side, which tilts first and then slides.
    words : str
        Where the detector goes from straight above.
    """

    primary_rad: float
    secondary_rad: float
    rotation_from_vertical_rad: float
    angulation_from_vertical_rad: float
    orbital_rad: float
    tilt_rad: float
    words: str


def carm_angles(entry_in_patient: Array, target_in_patient: Array, position: Position) -> CArmAngles | Refusal:
    """Angles in which the beam is parallel to a planned path.

    Parameters
    ----------
    entry_in_patient, target_in_patient : Array
        (3,) each, LPS, mm.
    position : Position
        How the patient lies; the DICOM angles do not depend on it, the dial does.

    Returns
    -------
    CArmAngles or Refusal
        `target_not_finite`, or `path_implausible` for a path too short, too long, or along the body.

    Notes
    -----
    The path from target to entry points from the source to the detector (docs/method.md).
    """
    path = np.asarray(entry_in_patient, dtype=np.float64) - np.asarray(target_in_patient, dtype=np.float64)
    refused = _check_path(path)
    if refused:
        return refused
    x, y, z = (float(component) for component in path / np.linalg.norm(path))
    left, up = _in_equipment(x, y, position)
    # arctangents where docs/method.md has arcsines: those lose half their digits near 90 deg
    secondary_rad = math.atan2(z, math.hypot(x, y))
    return CArmAngles(
        primary_rad=math.atan2(x, 0.0 - y),
        secondary_rad=secondary_rad,
        rotation_from_vertical_rad=math.atan2(left, up),
        angulation_from_vertical_rad=secondary_rad,
        orbital_rad=math.atan2(left, math.hypot(up, z)),
        tilt_rad=math.atan2(z, up),
        words=_words(math.atan2(left, up), secondary_rad, x),
    )


def beam_tilt_rad(primary_rad: float, secondary_rad: float) -> float:
    """Angle of the beam against the vertical, rad in [0, pi/2], of a patient who lies prone or supine.

    Notes
    -----
    DICOM's positioner angles put the beam's direction at (sin a cos b, -cos a cos b, sin b) in LPS (docs/method.md).
    """
    up = math.cos(primary_rad) * math.cos(secondary_rad)
    aside = math.hypot(math.sin(primary_rad) * math.cos(secondary_rad), math.sin(secondary_rad))
    return math.atan2(aside, abs(up))


def _check_path(path: Array) -> Refusal | None:
    if not np.isfinite(path).all():
        return Refusal(RefusalCode.TARGET_NOT_FINITE, "entry and target must be finite numbers")
    length_mm = float(np.linalg.norm(path))
    if length_mm < _LEAST_PATH_MM:
        return Refusal(
            RefusalCode.PATH_IMPLAUSIBLE, "the path is too short to aim along, mm", length_mm, _LEAST_PATH_MM
        )
    if length_mm > _GREATEST_PATH_MM:
        return Refusal(
            RefusalCode.PATH_IMPLAUSIBLE, "the path is too long for a body, mm", length_mm, _GREATEST_PATH_MM
        )
    across = math.hypot(path[0], path[1]) / length_mm
    if across < _LEAST_ACROSS:
        message = "the path runs along the body, where no C-arm can look: sine of the angle to its axis"
        return Refusal(RefusalCode.PATH_IMPLAUSIBLE, message, across, _LEAST_ACROSS)
    return None


def _in_equipment(x: float, y: float, position: Position) -> tuple[float, float]:
    """Components across the table and up, so that a supine patient's left is positive; 0 has no sign."""
    return (x, 0.0 - y) if position is Position.SUPINE else (0.0 - x, y)


def _words(rotation_rad: float, angulation_rad: float, patient_left: float) -> str:
    """Where the detector goes from straight above, as said aloud to the radiographer."""
    parts = [
        f"{math.degrees(abs(angle)):.1f} deg towards the patient's {side}"
        for angle, side in (
            (rotation_rad, "left" if patient_left > 0.0 else "right"),
            (angulation_rad, "head" if angulation_rad > 0.0 else "feet"),
        )
        if abs(math.degrees(angle)) >= 0.05
    ]
    return "detector " + (" and ".join(parts) if parts else "straight above")

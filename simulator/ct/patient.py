"""The patient of a CT, laid prone on the table."""

import numpy as np
from numpy.typing import NDArray

from simulator.carm.geometry import angles_of
from simulator.ct.anatomy import anatomy_of
from simulator.ct.plan import PlannedCt
from simulator.ct.reading import read_ct
from simulator.ct.volume import CtVolume
from simulator.frames import ROOM_FROM_PATIENT
from simulator.patient import MIDDLE_OF_TARGETS_MM, Patient
from simulator.pedicle import Pedicle

Array = NDArray[np.float64]


def patient_of(planned: PlannedCt) -> Patient:
    """The patient of a planned CT.

    Raises
    ------
    ValueError, OSError
        In one line: no readable CT, a target outside it, a path from which the table keeps the C-arm away.
    """
    volume = read_ct(planned.path)
    for pedicle in planned.pedicles.values():
        _check(pedicle, volume)
    return Patient(anatomy_of(volume), dict(planned.pedicles), _room_from_patient(planned))


def _check(pedicle: Pedicle, volume: CtVolume) -> None:
    if not volume.holds(pedicle.target_in_patient):
        raise ValueError(f"the target of {pedicle.name} lies outside the CT: points are LPS, mm, not voxels or RAS")
    try:
        angles_of(pedicle.entry_in_patient, pedicle.target_in_patient)
    except ValueError as error:
        raise ValueError(f"{pedicle.name}: {error}") from None


def _room_from_patient(planned: PlannedCt) -> Array:
    """A scanner's origin is anywhere: the planned targets come to lie about where the arm was placed for them."""
    middle = np.mean([pedicle.target_in_patient for pedicle in planned.pedicles.values()], axis=0)
    pose = ROOM_FROM_PATIENT.copy()
    pose[:3, 3] += pose[:3, :3] @ (np.array(MIDDLE_OF_TARGETS_MM) - middle)
    return pose

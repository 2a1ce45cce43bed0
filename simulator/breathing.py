"""How far the patient is from the mean place at a moment."""

import numpy as np
from numpy.typing import NDArray

from simulator.truth import PatientTruth

Array = NDArray[np.float64]

# Prone on a table the back rises and falls, and the spine slides a little along.
_ALONG = np.array([0.0, 0.9, 0.436])  # unit direction, patient frame


def until_expiration_s(truth: PatientTruth, time_s: float) -> float:
    """How long until the patient has next breathed out, where the breath rests for a moment."""
    return float((0.75 * truth.breathing_period_s - time_s) % truth.breathing_period_s)


def breathing_shift(truth: PatientTruth, time_s: float) -> Array:
    """Displacement (3,) in the patient frame, mm."""
    shift: Array = truth.breathing_mm * np.sin(2.0 * np.pi * time_s / truth.breathing_period_s) * _ALONG
    return shift

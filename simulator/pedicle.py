"""A planned path through a pedicle."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class Pedicle:
    """A planned path, DICOM patient coordinates (LPS), mm: from the skin to inside the pedicle."""

    name: str
    entry_in_patient: Array
    target_in_patient: Array

"""The paper's solution: intrinsics and rigid pose from the 12 fiducials, linearly."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.projection import View
from vision.refusal import Refusal

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True, eq=False)
class PaperSolution:
    """View, RMS distance of the 12 fiducials (px) and covariance (10, 10), parametrised as in `Registration`."""

    view: View
    residual_rms_px: float
    covariance: Array


def solve(fiducials_px: Mapping[str, Array], guide: Guide) -> PaperSolution | Refusal:
    """Intrinsics and pose from the 12 fiducials (2,), corrected pixels, by the normalised linear method."""
    raise NotImplementedError

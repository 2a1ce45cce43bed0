"""95 % bounds of the targeting error: the covariance of the fit carried through (2) to (7)."""

import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.projection import View
from vision.registered import DEFAULT_DEPTH_MM, PredictedError

Array = NDArray[np.float64]


def predicted_error(
    view: View, covariance: Array, guide: Guide, pixel_corrected: Array, depth_mm: float = DEFAULT_DEPTH_MM
) -> PredictedError:
    """Bounds for a target at `pixel_corrected` (2,), `depth_mm` below the big ring.

    Parameters
    ----------
    view : View
        The estimate.
    covariance : Array
        (10, 10), parametrised as in `Registration.covariance`.
    """
    raise NotImplementedError

"""Whether one quantity of the device files decides an aim, or an evaluated error, against the image (H06)."""

import numpy as np
from numpy.typing import NDArray

from vision.gates import check_trust_at
from vision.priors import Priors
from vision.projection import nominal_intrinsics
from vision.refusal import Refusal
from vision.registered import Registration, joint_covariance
from vision.strain import strain
from vision.wire_model import with_dimensions

Array = NDArray[np.float64]


def check_trust_in_files(
    registration: Registration, pixel: Array, depth_mm: float, guide_from_axis: Array | None = None
) -> Refusal | None:
    """At a target's own corrected pixel (2,) and depth: of the aim, or of an axis (4, 4) whose error is told.

    A registration by `paper` has nothing to compare: it takes the guide's dimensions from the file.
    """
    dimensions, carm, image = registration.dimensions, registration.carm, registration.image
    if dimensions is None:
        return None
    view, guide = registration.view(), registration.guide
    nominal = nominal_intrinsics(carm, image.rows, image.columns, registration.distortion.pixel_size_mm)
    priors = Priors.of(carm, guide, nominal)
    pulls_sd = priors.pulls(view, with_dimensions(guide, *dimensions.values_mm.tolist()))
    tests = strain(pulls_sd, priors.rows(), joint_covariance(registration.covariance, dimensions))
    return check_trust_at(view, tests, guide, pixel, depth_mm, guide_from_axis)

"""What a registration is: the record that targeting, evaluation and the database work from."""

from collections.abc import Mapping
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from vision.conics import RingPair
from vision.devices import CArm, Guide
from vision.distortion import DistortionMap
from vision.projection import Intrinsics, View

Array = NDArray[np.float64]

DEFAULT_DEPTH_MM = 80.0  # below the big ring, as in the paper


class Method(StrEnum):
    """How the view was solved: 12 points linearly, or all contour points."""

    CONTOUR = "contour"
    PAPER = "paper"


class PixelSpace(StrEnum):
    """In which grid a pixel was picked: as the image arrived, or after distortion correction."""

    RAW = "raw"
    CORRECTED = "corrected"


@dataclass(frozen=True, slots=True)
class ImageIdentity:
    """Which image, without a path."""

    sha256: str
    rows: int
    columns: int


@dataclass(frozen=True, slots=True)
class PredictedError:
    """95 % bounds of the angle between the guide's axis and the target ray, and of the distance at the depth."""

    angle_rad: float
    position_mm: float
    depth_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class FittedDimensions:
    """The guide's dimensions as the fit has them, within the tolerances of its file.

    Attributes
    ----------
    values_mm : Array
        (3,): radius of the small ring, of the big one, their separation.
    covariance : Array
        (3, 13): of these with the ten parameters of `Registration.covariance`, then with themselves.
    """

    values_mm: Array
    covariance: Array


@dataclass(frozen=True, slots=True, eq=False)
class Registration:
    """Intrinsics and pose of the guide from one image, with their covariance.

    Attributes
    ----------
    source_from_guide : Array
        (4, 4), mm.
    fiducials_px : Mapping[str, Array]
        The 12 fiducials (2,), corrected pixels, named by `conics.FIDUCIAL_NAMES`.
    bead_px : Array or None
        Centre of the bead (2,), corrected pixels; None for a guide without one.
    covariance : Array
        (10, 10) of alpha_x, alpha_y, u0, v0 (px), then a small rotation vector (rad) and a translation (mm), both in
        the source frame and applied on the left: source_from_guide = (Exp(w) R, t + dt). It holds image noise,
        distortion and the guide's tolerances of radius and separation; the bore's is added when it is propagated.
    predicted_error_95 : PredictedError
        For a target at the small ring's centre pixel.
    dimensions : FittedDimensions or None
        None for `paper`, which takes them from the file.
    """

    image: ImageIdentity
    method: Method
    guide: Guide
    carm: CArm
    intrinsics: Intrinsics
    source_from_guide: Array
    distortion: DistortionMap
    fiducials_px: Mapping[str, Array]
    bead_px: Array | None
    rings: RingPair
    residual_rms_px: float
    covariance: Array
    predicted_error_95: PredictedError
    elapsed_ms: float
    dimensions: FittedDimensions | None = None

    def view(self) -> View:
        """Intrinsics and pose together."""
        return View(self.intrinsics, self.source_from_guide)


def joint_covariance(covariance: Array, dimensions: FittedDimensions) -> Array:
    """(13, 13) of the ten parameters of `Registration.covariance` and the three dimensions."""
    count = len(covariance)
    whole = np.empty((count + 3, count + 3))
    whole[:count, :count] = covariance
    whole[count:] = dimensions.covariance
    whole[:, count:] = dimensions.covariance.T
    return whole

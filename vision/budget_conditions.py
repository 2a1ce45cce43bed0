"""Under which conditions a budget holds: one view, the devices, and how well everything is known."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.devices import CArm, Guide
from vision.distortion import DistortionMap, PlateFit, exact
from vision.ideal_fit import IdealFit
from vision.motion_agreement import MotionErrors
from vision.priors import Priors
from vision.projection import View, nominal_intrinsics, project
from vision.registered import DEFAULT_DEPTH_MM, Registration

Array = NDArray[np.float64]

# Of the reference view, where no image says better: what an ordinary image has.
_TILT_RAD = math.radians(10.0)
_DISTANCE_SHARE = 0.75  # of the source-to-image distance: small ring from the source
_SIDE_PX = 1024
_NOISE_PX = 0.05
_DEGREE = 6
_BALLS_RMS_PX = 0.09
NOISE_CORRELATION = 1.5  # variance of a mean of neighbouring pieces against that of independent ones, as measured
PIECE_PX = 4.0  # length of the pieces along the wires that the noise is told of (bands.py)


@dataclass(frozen=True, slots=True, eq=False)
class Conditions:
    """What a budget is made for.

    Attributes
    ----------
    view : View
        Before the move.
    noise_px : float
        Standard deviation of one piece of a wire across it.
    pixel_corrected : Array
        (2,), the target.
    depth_mm, depth_sd_mm : float
        Of the target below the big ring.
    motion : MotionErrors
        Of arm and TCP.
    """

    view: View
    guide: Guide
    carm: CArm
    plate: PlateFit
    noise_px: float
    pixel_corrected: Array
    depth_mm: float
    depth_sd_mm: float
    motion: MotionErrors

    @property
    def point_sd_px(self) -> float:
        """What one pixel of a wire's length is worth alone."""
        return self.noise_px * math.sqrt(NOISE_CORRELATION * PIECE_PX)

    def fit(self) -> IdealFit:
        """The estimator, its priors centred on the view."""
        priors = Priors.of(self.carm, self.guide, self.view.intrinsics)
        return IdealFit.of(self.view, self.guide, priors, self.plate, self.point_sd_px)


def reference_conditions(
    guide: Guide, carm: CArm, motion: MotionErrors, depth_sd_mm: float, depth_mm: float = DEFAULT_DEPTH_MM
) -> Conditions:
    """The reference view: 10 deg of tilt, three quarters of the way to the detector, the target at the TCP's pixel."""
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec([_TILT_RAD, 0.0, 0.0]).as_matrix()
    pose[:3, 3] = (10.0, -5.0, _DISTANCE_SHARE * carm.source_to_image_mm)
    view = View(nominal_intrinsics(carm, _SIDE_PX, _SIDE_PX), pose)
    pixel_size_mm = carm.field_of_view_mm / _SIDE_PX
    plate = exact(DistortionMap.identity(_SIDE_PX, _SIDE_PX, pixel_size_mm))
    if carm.plate is not None:
        terms = np.zeros(((_DEGREE + 1) * (_DEGREE + 2) // 2, 2))
        balls = round(math.pi / 4.0 * (carm.field_of_view_mm / carm.plate.ball_spacing_mm) ** 2)
        centre = (_SIDE_PX / 2.0 - 0.5, _SIDE_PX / 2.0 - 0.5)
        fitted = DistortionMap(centre, _SIDE_PX / 2.0, _DEGREE, terms, balls, _BALLS_RMS_PX, pixel_size_mm)
        plate = _plate(fitted, carm.plate.ball_spacing_mm)
    pixel = project(view, np.zeros((1, 3)))[0]
    return Conditions(view, guide, carm, plate, _NOISE_PX, pixel, depth_mm, depth_sd_mm, motion)


def conditions_of(
    registration: Registration,
    guide: Guide,
    carm: CArm,
    motion: MotionErrors,
    depth_sd_mm: float,
    depth_mm: float = DEFAULT_DEPTH_MM,
) -> Conditions:
    """Those of a registered image, its noise and its plate, the target at the small ring's centre.

    Raises
    ------
    ValueError
        Where the image is of another kind of detector than the C-arm file.
    """
    fitted = registration.distortion
    if (carm.plate is None) != (fitted.balls == 0):
        raise ValueError("the registration is of another kind of detector than the C-arm file")
    plate = exact(fitted) if carm.plate is None else _plate(fitted, carm.plate.ball_spacing_mm)
    noise_px, pixel = registration.residual_rms_px, registration.fiducials_px["small_centre"]
    return Conditions(registration.view(), guide, carm, plate, noise_px, pixel, depth_mm, depth_sd_mm, motion)


def _plate(fitted: DistortionMap, spacing_mm: float) -> PlateFit:
    """The map with the covariance that its balls give it, were they spread evenly over the round field."""
    spacing_px, radius_px = spacing_mm / fitted.pixel_size_mm, fitted.half_size_px
    steps = np.arange(-radius_px, radius_px, spacing_px)
    places = np.column_stack([axis.ravel() for axis in np.meshgrid(steps, steps)])
    sites = places[np.hypot(*places.T) < radius_px] + fitted.centre_px
    terms = fitted.basis(sites)
    normal = terms.T @ terms * (fitted.balls / len(sites))
    # rms counts both coordinates; the terms took their degrees of freedom
    variance = fitted.rms_px**2 / 2.0 * fitted.balls / (fitted.balls - terms.shape[1])
    known = exact(fitted)
    return PlateFit(fitted, variance * np.linalg.inv(normal), sites, known.balls)

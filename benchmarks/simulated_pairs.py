"""Pairs of registrations around a motion, every error drawn as it is configured: the contour fit on simulated points.

A case has one C-arm and one guide, drawn from what their files allow, a TCP calibration and an arm drawn from their
standard deviations, and noisy points on the wires of two images. What else moves between the two is said by the caller.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.conics import Ellipse, RingPair
from vision.contour import ContourFit, fit_contour
from vision.devices import CArm, Guide
from vision.distortion import DistortionMap, exact
from vision.motion_agreement import MotionAgreement, MotionErrors, compare_motion
from vision.priors import Priors
from vision.projection import Intrinsics, View, nominal_intrinsics
from vision.registered import FittedDimensions, ImageIdentity, Method, PredictedError, Registration
from vision.view_fit import Observations
from vision.wire_model import sample_wires, with_dimensions

Array = NDArray[np.float64]

MAP = DistortionMap.identity(1024, 1024, 360.0 / 1024.0)
STILL = np.eye(4)
NOISE_PX = 0.1
EVERY = 5  # neighbours along a wire are correlated: every fifth is worth about as much as all
_RINGS = RingPair(Ellipse((0.0, 0.0), (1.0, 1.0), 0.0), Ellipse((0.0, 0.0), (1.0, 1.0), 0.0))


def motion(turn_deg: Array, shift_mm: Array) -> Array:
    """A rigid motion (4, 4) by its rotation vector and translation."""
    moved = np.eye(4)
    moved[:3, :3] = Rotation.from_rotvec(np.asarray(turn_deg, dtype=float), degrees=True).as_matrix()
    moved[:3, 3] = shift_mm
    return moved


@dataclass(frozen=True)
class Room:
    """One C-arm and one guide as they truly are, and what a fit makes of the guide somewhere before it."""

    guide: Guide
    carm: CArm
    made: Guide
    intrinsics: Intrinsics

    @classmethod
    def draw(cls, guide: Guide, carm: CArm, rng: np.random.Generator) -> "Room":
        """Within the tolerances of the files."""
        sd, nominal = guide.tolerance, nominal_intrinsics(carm, 1024, 1024)
        made = with_dimensions(
            guide,
            guide.small_ring_radius_mm + rng.normal(0.0, sd.radius_sd_mm),
            guide.big_ring_radius_mm + rng.normal(0.0, sd.radius_sd_mm),
            guide.separation_mm + rng.normal(0.0, sd.separation_sd_mm),
        )
        alpha = nominal.alpha_x_px * (1.0 + rng.normal(0.0, carm.source_to_image_sd_mm) / carm.source_to_image_mm)
        centre = 511.5 + rng.normal(0.0, carm.principal_point_sd_px, 2)
        return cls(guide, carm, made, Intrinsics(alpha, alpha, float(centre[0]), float(centre[1])))

    def seen(self, source_from_guide: Array, rng: np.random.Generator, scale: float = 1.0) -> Registration:
        """Registered from noisy points; a guide scaled by `scale` looks like one nearer or farther by that."""
        apparent = source_from_guide.copy()
        apparent[:3, 3] /= scale
        samples = sample_wires(View(self.intrinsics, apparent), self.made)
        samples = samples.chosen(np.arange(len(samples.along)) % EVERY == 0)
        measured = samples.points + rng.normal(0.0, NOISE_PX, (len(samples.along), 1)) * samples.normals
        none = np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0)
        along = samples.along
        observations = Observations(samples.wire, along, measured, samples.normals, np.zeros(len(along)), *none)
        nominal = nominal_intrinsics(self.carm, 1024, 1024)
        priors = Priors.of(self.carm, self.guide, nominal)
        return self._registration(fit_contour(View(nominal, apparent), self.guide, observations, priors, exact(MAP)))

    def _registration(self, fit: ContourFit) -> Registration:
        values_mm = (fit.guide.small_ring_radius_mm, fit.guide.big_ring_radius_mm, fit.guide.separation_mm)
        return Registration(
            image=ImageIdentity("ab" * 32, 1024, 1024),
            method=Method.CONTOUR,
            guide=self.guide,
            carm=self.carm,
            intrinsics=fit.view.intrinsics,
            source_from_guide=fit.view.source_from_guide,
            distortion=MAP,
            fiducials_px={},
            bead_px=None,
            rings=_RINGS,
            residual_rms_px=NOISE_PX,
            covariance=fit.covariance[:10, :10],
            predicted_error_95=PredictedError(0.0, 0.0, 80.0),
            elapsed_ms=0.0,
            dimensions=FittedDimensions(np.array(values_mm), fit.covariance[10:]),
        )


@dataclass(frozen=True)
class Moved:
    """A pair of images around a motion of the arm, and of what else moved between them."""

    room: Room
    before: Array  # source_from_guide, true
    planned: Array  # before_from_after by the arm

    @classmethod
    def draw(cls, room: Room, rng: np.random.Generator) -> "Moved":
        """Tilted anyhow, near the middle; some 15 mm and 5 deg on, its distance from the source kept as (3) does."""
        before = motion(rng.normal(0.0, 8.0, 3), np.array([*rng.uniform(-30.0, 30.0, 2), 750.0]))
        after = before @ motion(rng.normal(0.0, 5.0, 3), rng.normal(0.0, 15.0, 3))
        after[:3, 3] *= np.linalg.norm(before[:3, 3]) / np.linalg.norm(after[:3, 3])
        return cls(room, before, np.linalg.inv(before) @ after)

    def compared(
        self, rng: np.random.Generator, errors: MotionErrors, displaced: Array = STILL, scale: float = 1.0
    ) -> MotionAgreement:
        """With errors drawn; `displaced` turns and shifts the second guide about its ring, in source directions."""
        tool = _drawn(rng, errors.tcp_rad, errors.tcp_mm)
        arm_before, arm_after = (_drawn(rng, errors.arm_rad, errors.arm_mm) for _ in range(2))
        # guide = reported pose, the arm's error, the tool's error: the same tool in both
        after = self.before @ np.linalg.inv(arm_before @ tool) @ self.planned @ arm_after @ tool
        after[:3, :3] = displaced[:3, :3] @ after[:3, :3]
        after[:3, 3] += displaced[:3, 3]
        first, second = (self.room.seen(pose, rng, scale) for pose in (self.before, after))
        return compare_motion(first, second, self.planned, errors)


def _drawn(rng: np.random.Generator, rad: float, mm: float) -> Array:
    return motion(np.degrees(rng.normal(0.0, rad, 3)), rng.normal(0.0, mm, 3))

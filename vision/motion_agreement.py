"""Whether the guide moved between two images as the arm says it did (H03): one chi-square over 6 degrees of freedom.

The rings' motion holds what moved against the C-arm, the arm's only what moved against its base. Both images were taken
by one C-arm of one guide: intrinsics and dimensions are made one before the motions are compared, or their errors,
which cancel in the motion, would hide it.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation
from scipy.special import chdtri, chndtrinc

from vision.common_grid import similarity_between
from vision.priors import VIEW_PARAMETERS, Priors
from vision.projection import Intrinsics, View, nominal_intrinsics
from vision.registered import FittedDimensions, Registration, joint_covariance
from vision.wire_model import with_dimensions

Array = NDArray[np.float64]

FALSE_ALARMS = 0.005
SEEN = 0.99
CHI_SQUARE_LIMIT = float(chdtri(6, FALSE_ALARMS))
# Length of a discrepancy, in its standard deviations, that is seen: 6.15.
DETECTABLE_SD = float(np.sqrt(chndtrinc(CHI_SQUARE_LIMIT, 6, 1.0 - SEEN)))

_ONE = VIEW_PARAMETERS + 3  # parameters of one image
_SHARED = [0, 1, 2, 3, 10, 11, 12]  # alpha_x, alpha_y, u0, v0, two radii, separation
_ROTATION, _TRANSLATION = slice(4, 7), slice(7, 10)
_POSES = [*range(4, 10), *range(_ONE + 4, _ONE + 10)]
# How well two grids are one (px), and one guide the same at two moments (mm): far below anything that is measured.
_SHARED_SLACK = np.array([0.05] * 4 + [1e-3] * 3)


@dataclass(frozen=True, slots=True)
class MotionErrors:
    """Standard deviations along and about each axis: of a pose that the arm reports, of the TCP calibration."""

    arm_rad: float
    arm_mm: float
    tcp_rad: float
    tcp_mm: float


@dataclass(frozen=True, slots=True)
class RelativeMotion:
    """A motion of the C-arm against the arm's base, at the small ring: turn, shift across and along the beam."""

    rotation_rad: float
    across_mm: float
    along_mm: float


@dataclass(frozen=True, slots=True)
class MotionAgreement:
    """The chi-square, the difference of the two motions, and what would have been seen in 99 % of cases."""

    chi_square: float
    difference: RelativeMotion
    detectable: RelativeMotion

    @property
    def limit(self) -> float:
        """What the chi-square may be."""
        return CHI_SQUARE_LIMIT


@dataclass(frozen=True, slots=True, eq=False)
class _Pair:
    """Two views with the joint covariance (26, 26) of their errors."""

    before: View
    after: View
    covariance: Array


def compare_motion(
    before: Registration, after: Registration, before_from_after: Array, errors: MotionErrors
) -> MotionAgreement:
    """Compare what the rings did with what the arm did.

    Parameters
    ----------
    before, after : Registration
        By contour, of two images of one C-arm pose.
    before_from_after : Array
        (4, 4), mm: the guide's pose during the second exposure in its own frame during the first, by the arm.
    errors : MotionErrors
        Of the arm and of the TCP calibration.

    Returns
    -------
    MotionAgreement
        chi_square is eta^T S^-1 eta with eta (6,) the turn and shift, in the source frame at the second small ring,
        that lead from the arm's motion to the rings', and S its covariance.
    """
    pair, excess = _one_carm(before, after)
    difference = _difference(pair, before_from_after) - _derivative(pair) @ excess
    spread = _spread(pair, errors)
    beam = _beam(pair.after)
    return MotionAgreement(
        chi_square=float(difference @ np.linalg.solve(spread, difference)),
        difference=_split(difference, beam),
        detectable=_detectable(spread, beam),
    )


def detectable_motion(before: Registration, before_from_after: Array, errors: MotionErrors) -> RelativeMotion:
    """What `compare_motion` will see in 99 % of cases after a planned motion, were the second image as good."""
    view = before.view()
    after = View(view.intrinsics, view.source_from_guide @ before_from_after)
    farther = np.ones(_ONE)
    farther[_TRANSLATION] = after.source_from_guide[2, 3] / view.source_from_guide[2, 3]
    one, prior = _covariance(before), _prior_information(before)
    # from elsewhere, the same errors of the intrinsics displace the guide in proportion to its distance
    pair = _Pair(view, after, _joined(one, one * np.outer(farther, farther), prior))
    pair, _ = _conditioned(pair, np.zeros(len(_SHARED)))
    return _detectable(_spread(pair, errors), _beam(after))


def _one_carm(before: Registration, after: Registration) -> tuple[_Pair, Array]:
    """Both views in the first one's grid, and by how much the 26 parameters are too large for one C-arm and guide."""
    second = similarity_between(before.distortion, after.distortion).view(after.view())
    apart = _shared_values(before.intrinsics, before) - _shared_values(second.intrinsics, after)
    return _conditioned(_Pair(before.view(), second, _joint_covariance(before, after)), apart)


def _conditioned(pair: _Pair, apart: Array) -> tuple[_Pair, Array]:
    """The pair, and what all 26 parameters are to be lowered by, once the shared ones (7,) are `apart` no more."""
    condition = np.zeros((len(_SHARED), 2 * _ONE))
    for row, column in enumerate(_SHARED):
        condition[row, column], condition[row, _ONE + column] = 1.0, -1.0
    spread = condition @ pair.covariance @ condition.T + np.diag(_SHARED_SLACK**2)
    gain = np.linalg.solve(spread, condition @ pair.covariance).T
    return _Pair(pair.before, pair.after, pair.covariance - gain @ condition @ pair.covariance), gain @ apart


def _joint_covariance(before: Registration, after: Registration) -> Array:
    """Of the errors of both fits (26, 26). Each leans on the same priors, whose own error they therefore share.

    A fit with information L and prior P errs by -(L + P)^-1 P d + noise, d the prior's error with covariance P^-1.
    """
    return _joined(_covariance(before), _covariance(after), _prior_information(before))


def _joined(one: Array, two: Array, prior: Array) -> Array:
    across = one[:, _SHARED] @ prior @ two[_SHARED]
    return np.block([[one, across], [across.T, two]])


def _covariance(registration: Registration) -> Array:
    """All 13 parameters of one image."""
    return joint_covariance(registration.covariance, _dimensions(registration))


def _prior_information(registration: Registration) -> Array:
    """(7, 7) of the shared parameters, from the device files; the pulls are linear in them."""
    image, pixel_size_mm = registration.image, registration.distortion.pixel_size_mm
    nominal = nominal_intrinsics(registration.carm, image.rows, image.columns, pixel_size_mm)
    priors = Priors.of(registration.carm, registration.guide, nominal)
    view, guide = registration.view(), registration.guide
    here = _shared_of(view.intrinsics, (guide.small_ring_radius_mm, guide.big_ring_radius_mm, guide.separation_mm))

    def pulls(values: Array) -> Array:
        moved = View(Intrinsics(*map(float, values[:4])), view.source_from_guide)
        return np.array(list(priors.pulls(moved, with_dimensions(guide, *map(float, values[4:]))).values()))

    jacobian = np.column_stack([pulls(here + step) - pulls(here) for step in np.eye(len(_SHARED))])
    return np.asarray(jacobian.T @ jacobian)


def _shared_values(intrinsics: Intrinsics, registration: Registration) -> Array:
    return _shared_of(intrinsics, _dimensions(registration).values_mm)


def _shared_of(intrinsics: Intrinsics, dimensions_mm: Array | tuple[float, ...]) -> Array:
    numbers = (intrinsics.alpha_x_px, intrinsics.alpha_y_px, intrinsics.u0_px, intrinsics.v0_px, *dimensions_mm)
    return np.array(numbers, dtype=np.float64)


def _dimensions(registration: Registration) -> FittedDimensions:
    if registration.dimensions is None:
        raise ValueError("motions are compared between contour registrations")
    return registration.dimensions


def _difference(pair: _Pair, before_from_after: Array) -> Array:
    """Turn (rad) and shift (mm), (6,), source frame at the second small ring, from the arm's motion to the rings'."""
    predicted = pair.before.source_from_guide @ before_from_after
    seen = pair.after.source_from_guide
    turn = Rotation.from_matrix(seen[:3, :3] @ predicted[:3, :3].T).as_rotvec()
    return np.concatenate((turn, seen[:3, 3] - predicted[:3, 3]))


def _derivative(pair: _Pair) -> Array:
    """(6, 26) of the difference by both images' parameters: the first one's turn swings the second guide about."""
    jacobian = np.zeros((6, 2 * _ONE))
    jacobian[:3, _ROTATION], jacobian[3:, _TRANSLATION] = -np.eye(3), -np.eye(3)
    jacobian[3:, _ROTATION] = _swing(pair)
    jacobian[:3, _ONE + 4 : _ONE + 7], jacobian[3:, _ONE + 7 : _ONE + 10] = np.eye(3), np.eye(3)
    return jacobian


def _swing(pair: _Pair) -> Array:
    """(3, 3): the way between the two small rings, crossed with a turn of the first."""
    x, y, z = pair.after.source_from_guide[:3, 3] - pair.before.source_from_guide[:3, 3]
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def _spread(pair: _Pair, errors: MotionErrors) -> Array:
    """Covariance (6, 6) of the difference: images, two poses of the arm, one TCP calibration."""
    rings = _derivative(pair)
    arm = rings[:, _POSES]
    arm_sd = np.array([errors.arm_rad] * 3 + [errors.arm_mm] * 3)
    tcp_sd = np.array([errors.tcp_rad] * 3 + [errors.tcp_mm] * 3)
    first, second = pair.before.source_from_guide[:3, :3], pair.after.source_from_guide[:3, :3]
    # an error fixed to the flange turns with the guide, so that only the difference of both places is left of it
    tcp = np.zeros((6, 6))
    tcp[:3, :3] = tcp[3:, 3:] = second - first
    tcp[3:, :3] = _swing(pair) @ first
    arm_covariance = (arm * np.tile(arm_sd, 2) ** 2) @ arm.T
    return np.asarray(rings @ pair.covariance @ rings.T + arm_covariance + (tcp * tcp_sd**2) @ tcp.T)


def _beam(view: View) -> Array:
    """Unit direction (3,) from the source to the small ring."""
    place = view.source_from_guide[:3, 3]
    return np.asarray(place / np.linalg.norm(place))


def _split(difference: Array, beam: Array) -> RelativeMotion:
    along = float(difference[3:] @ beam)
    across = difference[3:] - along * beam
    return RelativeMotion(float(np.linalg.norm(difference[:3])), float(np.linalg.norm(across)), abs(along))


def _detectable(spread: Array, beam: Array) -> RelativeMotion:
    """The least that is seen whatever its direction: a turn alone, a shift alone across or along the beam."""
    information = np.linalg.inv(spread)
    across = np.linalg.svd(beam[None])[2][1:]
    shift = information[3:, 3:]
    return RelativeMotion(
        rotation_rad=DETECTABLE_SD / float(np.sqrt(np.linalg.eigvalsh(information[:3, :3])[0])),
        across_mm=DETECTABLE_SD / float(np.sqrt(np.linalg.eigvalsh(across @ shift @ across.T)[0])),
        along_mm=DETECTABLE_SD / float(np.sqrt(beam @ shift @ beam)),
    )

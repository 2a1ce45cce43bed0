"""Interlocks of a verification, of a correction made from its image and of the insertion that relies on it."""

from workflow.checks import Interlock, bounded, given, id_of, same, since, yes
from workflow.facts import CorrectionRequested, Evaluated
from workflow.findings import Finding, is_true, within
from workflow.inquiry import Inquiry
from workflow.triggers import Trigger

_EXPOSE = (Trigger.EXPOSURE_REQUESTED,)
_REVERIFY = (Trigger.VERIFICATION_REJECTED,)


def _sum(error: float | None, bound: float | None) -> float | None:
    return None if error is None or bound is None else error + bound


def _figures_plausible(inquiry: Inquiry) -> Finding:
    """Every figure is a magnitude that the guide's field can show."""
    facts, limits = inquiry.given(Evaluated), inquiry.limits
    if facts is None:
        return is_true(None)
    findings = (
        within(facts.angle_error_rad, limits.evaluation_angle_rad, "rad"),
        within(facts.angle_bound_rad, limits.evaluation_angle_rad, "rad"),
        within(facts.position_error_mm, limits.evaluation_position_mm, "mm"),
        within(facts.position_bound_mm, limits.evaluation_position_mm, "mm"),
    )
    return next((finding for finding in findings if not finding.passed), is_true(True))


def _verification_newer(inquiry: Inquiry) -> Finding:
    """It judged the newest motion; where the motion is void its start would have voided both (a turned C-arm)."""
    verification, motion = inquiry.case.verification, inquiry.case.motion
    if verification is None or not verification.passed:
        return is_true(None)
    return is_true(motion is None or motion.id == verification.motion_id)


FIGURES_PLAUSIBLE = Interlock(
    "figures_plausible", "H09", "an evaluated figure is out of range", _figures_plausible, _EXPOSE, asks=True
)
IMAGE_EVALUATED = Interlock(
    "image_evaluated",
    "H28",
    "not the image that was requested after the motion",
    same(given(Evaluated, lambda e: e.image_id), lambda i: id_of(i.case.evaluated_image)),
    _EXPOSE,
    asks=True,
)
EVALUATIONS_AGREE = Interlock(
    "evaluations_agree",
    "H33",
    "paper and contour evaluation disagree",
    yes(given(Evaluated, lambda e: e.agree)),
    _EXPOSE,
    asks=True,
)
MOTION_AGREES = Interlock(
    "motion_agrees",
    "H03",
    "the guide moved otherwise in the images than the arm says: C-arm or base moved, or the TCP or guide file is wrong",
    bounded(given(Evaluated, lambda e: e.motion_chi_square), lambda limits: limits.motion_chi_square, ""),
    (Trigger.CARM_POSITION_CONFIRMED,),
    asks=True,
)
ANATOMY_ACROSS = Interlock(
    "anatomy_across",
    "H34",
    "the anatomy shifted across the beam between the two images",
    bounded(given(Evaluated, lambda e: e.anatomy_across_mm), lambda limits: limits.anatomy_across_mm, "mm"),
    _EXPOSE,
    asks=True,
)
ANATOMY_ALONG = Interlock(
    "anatomy_along",
    "H34",
    "the anatomy shifted along the beam between the two images",
    bounded(given(Evaluated, lambda e: e.anatomy_along_mm), lambda limits: limits.anatomy_along_mm, "mm"),
    _EXPOSE,
    asks=True,
)
# No hazard of its own: it is what every hazard before it would show in, and what the insertion waits for (H28).
ANGLE_ERROR = Interlock(
    "angle_error",
    "H28",
    "the guide's angle error, with its 95 % bound, exceeds the limit",
    bounded(
        given(Evaluated, lambda e: _sum(e.angle_error_rad, e.angle_bound_rad)),
        lambda limits: limits.angle_error_rad,
        "rad",
    ),
    (Trigger.CORRECTION_REQUESTED,),
    asks=True,
)
POSITION_ERROR = Interlock(
    "position_error",
    "H28",
    "the guide's position error, with its 95 % bound, exceeds the limit",
    bounded(
        given(Evaluated, lambda e: _sum(e.position_error_mm, e.position_bound_mm)),
        lambda limits: limits.position_error_mm,
        "mm",
    ),
    (Trigger.CORRECTION_REQUESTED,),
    asks=True,
)
CORRECTION_IMAGE = Interlock(
    "correction_image",
    "H22",
    "the correction was made from another image",
    same(
        given(CorrectionRequested, lambda c: c.image_id),
        lambda i: i.case.verification.image_id if i.case.verification else None,
    ),
    _REVERIFY,
    asks=True,
)
VERIFICATION_NEWER = Interlock(
    "verification_newer", "H28", "no passed verification of the newest motion", _verification_newer, _REVERIFY
)
VERIFICATION_AGE = Interlock(
    "verification_age",
    "H28",
    "the verification is old",
    since(
        lambda i: i.case.verification.judged_s if i.case.verification else None,
        lambda limits: limits.verification_age_s,
    ),
    _REVERIFY,
)

"""Which interlocks judge which trigger: data, so that a reader and a test can see what is missing."""

from collections.abc import Iterable

from workflow import arm_interlocks as arm
from workflow import configuration_interlocks as configuration
from workflow import image_interlocks as image
from workflow import motion_interlocks as motion
from workflow import path_interlocks as path
from workflow import verification_interlocks as verification
from workflow.checks import Interlock
from workflow.inquiry import Inquiry
from workflow.plans import AIMED, PlanKind
from workflow.states import State
from workflow.triggers import Trigger
from workflow.verdicts import Verdict

_FEEDBACK = (arm.FEEDBACK_FRESH, arm.JOINTS_FRESH, arm.FEEDBACK_FINITE, arm.FEEDBACK_ADVANCES)
_READY_ARM = (arm.AT_REST, arm.GUARD_ALIVE, arm.SAFETY_NORMAL, *_FEEDBACK)
_DEVICES = (arm.DEVICES_IN_DATE, arm.TCP_MM, arm.TCP_RAD, arm.PAYLOAD_KG)
_IDENTITY = (image.PATIENT_MATCHES, image.STUDY_MATCHES)
UNSEEN = (image.IMAGE_UNSEEN, image.PIXELS_UNSEEN, image.IMAGE_NEWER)
_ARRIVED = (*_IDENTITY, *UNSEEN, image.WINDOW_OPEN, image.STILL_MM, image.STILL_RAD)
_REGISTRATION = (
    image.HANDEDNESS,
    image.PLATE,
    image.SCALE,
    image.FIDUCIALS,
    image.RESIDUAL,
    image.PREDICTED_ANGLE,
    image.PREDICTED_POSITION,
)
_MOTION = (*_READY_ARM, *_DEVICES, motion.GUIDE_EMPTY, motion.NO_INSERTION)
EVALUATION = (verification.FIGURES_PLAUSIBLE, verification.IMAGE_EVALUATED, verification.EVALUATIONS_AGREE)
# Two images hold these against each other; what fails voids the view, or the image.
VIEW_KEPT = (verification.MOTION_AGREES,)
PATIENT_KEPT = (verification.ANATOMY_ACROSS, verification.ANATOMY_ALONG)
VERIFICATION_LIMITS = (verification.ANGLE_ERROR, verification.POSITION_ERROR)
_VERIFICATION = (*EVALUATION, *VIEW_KEPT, *PATIENT_KEPT, *VERIFICATION_LIMITS)
# The pose held during the exposure is only worth something while every displacement since is accounted for.
_POSE_KEPT = (arm.UNACCOUNTED_MM, arm.UNACCOUNTED_RAD)
_IMAGE_KEPT = (image.IMAGE_AGE, *_POSE_KEPT)

REQUIRED: dict[Trigger, tuple[Interlock, ...]] = {
    Trigger.CARM_POSITION_CONFIRMED: (arm.AT_REST, arm.DEVICES_IN_DATE),
    Trigger.EXPOSURE_REQUESTED: (arm.AT_REST, *_FEEDBACK, motion.GUIDE_KNOWN),
    Trigger.IMAGE_ARRIVED: _ARRIVED,
    Trigger.NEWEST_IMAGE_REUSED: (image.NEWEST_IMAGE, image.GUIDE_IN_IMAGE, *_POSE_KEPT),
    Trigger.REGISTRATION_COMPLETED: _REGISTRATION,
    Trigger.TARGET_CONFIRMED: (image.IMAGE_AGE, image.TARGET_ECHO, image.TARGET_IMAGE, image.TARGET_REGISTRATION),
    Trigger.PLAN_REQUESTED: (motion.PLAN_PLAUSIBLE, motion.PLAN_PARENTS, *path.ALL),
    Trigger.MOVE_APPROVED: (
        motion.PLAN_CURRENT,
        motion.SURGEON,
        motion.PIN,
        motion.LEASE,
        motion.DEVICES_KNOWN,
        motion.PLAN_PARENTS,
        arm.ARM_WHERE_PLANNED,
        *_MOTION,
    ),
    Trigger.MOVE_STARTED: (
        motion.PERMIT_CURRENT,
        motion.PERMIT_UNUSED,
        motion.PERMIT_FRESH,
        motion.PERMIT_HOLDER,
        motion.PERMIT_PARENTS,
        motion.PERMIT_JOINTS,
        motion.PERMIT_DEVICES,
        motion.PERMIT_GUIDE,
        motion.LEASE,
        arm.HOLD_PRESSED,
        arm.HEARTBEAT_FRESH,
        arm.CHALLENGE_ECHOED,
        arm.CHALLENGE_FRESH,
        *_MOTION,
    ),
    Trigger.VERIFICATION_PASSED: _VERIFICATION,
    Trigger.VERIFICATION_FAILED: _VERIFICATION,
    Trigger.CORRECTION_REQUESTED: (verification.CORRECTION_IMAGE, *_REGISTRATION, *_IMAGE_KEPT),
    Trigger.INSERTION_STARTED: (
        motion.SURGEON,
        motion.PIN,
        motion.LEASE,
        verification.VERIFICATION_NEWER,
        verification.VERIFICATION_AGE,
        arm.SCRIPT_STOPPED,
        arm.MOTION_LOCKED,
        arm.DRIFT_MM,
        arm.DRIFT_RAD,
        *_READY_ARM,
    ),
    Trigger.ACKNOWLEDGED: (*_READY_ARM, motion.GUIDE_KNOWN, motion.GUIDE_RESTATED),
}

# An image that fails one of these may be another patient's or an old one: it goes to quarantine.
PROVENANCE = (*_IDENTITY, *UNSEEN)
# An image that passes these shows what is there now, asked for or not: it may be reused.
CLEAN_IMAGE = (*PROVENANCE, image.STILL_MM, image.STILL_RAD)

# Only a motion onto a target uses an image and the pose held during its exposure; the others have none to be true to.
_AIMED = (*_IMAGE_KEPT, motion.AIM_ANGLE, motion.AIM_POSITION)
_AIMED_REQUIRED: dict[Trigger, tuple[Interlock, ...]] = {
    Trigger.PLAN_REQUESTED: _AIMED,
    Trigger.MOVE_APPROVED: _AIMED,
    Trigger.MOVE_STARTED: _AIMED,
}
_STATE_REQUIRED: dict[tuple[Trigger, State], tuple[Interlock, ...]] = {
    (Trigger.IMAGE_ARRIVED, State.MOVED): (image.IMAGE_AFTER_MOTION,),
}
# Under another configuration a case goes no further: what is left is to stop, state, retreat and close, and what leads
# there (control, acknowledgement, the end of an insertion), and words.
GOES_FURTHER = frozenset(
    {
        Trigger.CARM_POSITION_CONFIRMED,
        Trigger.EXPOSURE_REQUESTED,
        Trigger.NEWEST_IMAGE_REUSED,
        Trigger.RETAKE,
        Trigger.TARGET_CONFIRMED,
        Trigger.TARGET_WITHDRAWN,
        Trigger.PLAN_REQUESTED,
        Trigger.MOVE_APPROVED,
        Trigger.MOVE_STARTED,
        Trigger.CORRECTION_REQUESTED,
        Trigger.VERIFICATION_REJECTED,
        Trigger.INSERTION_STARTED,
    }
)
_MOVES = (Trigger.PLAN_REQUESTED, Trigger.MOVE_APPROVED, Trigger.MOVE_STARTED)
_PINNED = (configuration.CONFIGURATION,)
_TABLES: tuple[Iterable[tuple[Interlock, ...]], ...] = (
    REQUIRED.values(),
    _AIMED_REQUIRED.values(),
    _STATE_REQUIRED.values(),
    (_PINNED,),
)
INTERLOCKS: dict[str, Interlock] = {lock.code: lock for table in _TABLES for locks in table for lock in locks}


def required(inquiry: Inquiry) -> tuple[Interlock, ...]:
    """The interlocks that judge this question."""
    trigger = inquiry.trigger
    always = REQUIRED.get(trigger, ())
    aimed = _AIMED_REQUIRED.get(trigger, ()) if inquiry.plan_kind in AIMED else ()
    pinned = _PINNED if _goes_further(inquiry) else ()
    return (*always, *aimed, *_STATE_REQUIRED.get((trigger, inquiry.case.state), ()), *pinned)


def _goes_further(inquiry: Inquiry) -> bool:
    """Neither a retreat, nor the mere question whether a plan, which may be a retreat's, can be asked for."""
    asked_only = inquiry.trigger is Trigger.PLAN_REQUESTED and inquiry.facts is None
    retreats = inquiry.trigger in _MOVES and inquiry.plan_kind is PlanKind.RETREAT
    return inquiry.trigger in GOES_FURTHER and not asked_only and not retreats


def judge(inquiry: Inquiry) -> tuple[Verdict, ...]:
    """Every verdict; where only the standing is asked, of those that need nothing that comes with a request."""
    return tuple(lock.judge(inquiry) for lock in required(inquiry) if inquiry.facts is not None or not lock.asks)


def provenance(inquiry: Inquiry) -> tuple[Verdict, ...]:
    """Every verdict on whose an image is and whether it is new, whatever became of it on its arrival."""
    return tuple(lock.judge(inquiry) for lock in PROVENANCE)

"""What a trigger turns out to be: the choice between the rows that one state has for it."""

from collections.abc import Callable, Sequence

from workflow.facts import Evaluated, GuideStated, MotionEnded, RegistrationCompleted, RegistrationRefused
from workflow.facts import VerificationRefused as EvaluationRefused
from workflow.findings import within
from workflow.inquiry import Inquiry
from workflow.interlocks import EVALUATION, PATIENT_KEPT, VERIFICATION_LIMITS, VIEW_KEPT
from workflow.plans import AIMED
from workflow.rows import Branch
from workflow.states import GuideState, InsertionStatus
from workflow.triggers import Trigger
from workflow.verdicts import Verdict

Verdicts = Sequence[Verdict]
_EVALUATION = frozenset(lock.code for lock in EVALUATION)
_VIEW = frozenset(lock.code for lock in VIEW_KEPT)
_PATIENT = frozenset(lock.code for lock in PATIENT_KEPT)
_LIMITS = frozenset(lock.code for lock in VERIFICATION_LIMITS)


def _fails(verdicts: Verdicts, codes: frozenset[str]) -> bool:
    return any(not verdict.passed for verdict in verdicts if verdict.code in codes)


def _unmeasured(verdicts: Verdicts, codes: frozenset[str]) -> bool:
    return any(verdict.measured is None for verdict in verdicts if verdict.code in codes)


def _image(_: Inquiry, verdicts: Verdicts) -> Branch:
    return Branch.ACCEPTED if all(verdict.passed for verdict in verdicts) else Branch.OTHERWISE


def _awaits_registration(inquiry: Inquiry, image_id: str) -> bool:
    case = inquiry.case
    return case.image is not None and case.image.id == image_id and case.registration is None


def _registered(inquiry: Inquiry, verdicts: Verdicts) -> Branch:
    if not _awaits_registration(inquiry, inquiry.told(RegistrationCompleted).image_id):
        return Branch.LATE
    return Branch.SOUND if all(verdict.passed for verdict in verdicts) else Branch.UNSOUND


def _not_registered(inquiry: Inquiry, _: Verdicts) -> Branch:
    current = _awaits_registration(inquiry, inquiry.told(RegistrationRefused).image_id)
    return Branch.CURRENT if current else Branch.LATE


def _is_running(inquiry: Inquiry, ended: MotionEnded) -> bool:
    return inquiry.case.running is not None and inquiry.case.running.id == ended.motion_id


def _arrived(inquiry: Inquiry, _: Verdicts) -> Branch:
    ended, limits, running = inquiry.told(MotionEnded), inquiry.limits, inquiry.case.running
    if running is None or not _is_running(inquiry, ended):
        return Branch.LATE
    if ended.at_rest is not True:
        return Branch.ADRIFT
    near = within(ended.distance_mm, limits.arrival_mm, "mm").passed
    straight = within(ended.angle_rad, limits.arrival_rad, "rad").passed
    return Branch.AT_GOAL if running.kind in AIMED and near and straight else Branch.ELSEWHERE


def _ended(inquiry: Inquiry, _: Verdicts) -> Branch:
    ended = inquiry.told(MotionEnded)
    if not _is_running(inquiry, ended):
        return Branch.LATE
    return Branch.AT_REST if ended.at_rest is True else Branch.ADRIFT


def _is_evaluated(inquiry: Inquiry, image_id: str) -> bool:
    case = inquiry.case
    return case.motion is not None and case.evaluated_image is not None and case.evaluated_image.id == image_id


def _passed(inquiry: Inquiry, verdicts: Verdicts) -> Branch:
    branch = _failed(inquiry, verdicts)
    return Branch.PASSED if branch is Branch.EXCEEDED and not _fails(verdicts, _LIMITS) else branch


def _failed(inquiry: Inquiry, verdicts: Verdicts) -> Branch:
    """Who says failed is believed, within the limits or not."""
    if not _is_evaluated(inquiry, inquiry.told(Evaluated).image_id):
        return Branch.LATE
    if _fails(verdicts, _EVALUATION) or _unmeasured(verdicts, _VIEW | _PATIENT):
        return Branch.UNUSABLE
    if _fails(verdicts, _VIEW):
        return Branch.VIEW_MOVED
    return Branch.PATIENT_SHIFTED if _fails(verdicts, _PATIENT) else Branch.EXCEEDED


def _not_evaluated(inquiry: Inquiry, _: Verdicts) -> Branch:
    current = _is_evaluated(inquiry, inquiry.told(EvaluationRefused).image_id)
    return Branch.CURRENT if current else Branch.LATE


def _cancelled(inquiry: Inquiry, _: Verdicts) -> Branch:
    insertion = inquiry.case.insertion
    is_open = insertion is not None and insertion.status is InsertionStatus.OPEN
    return Branch.INSERTION_OPEN if is_open else Branch.INSERTION_NOT_OPEN


def _guide(inquiry: Inquiry, _: Verdicts) -> Branch:
    if inquiry.case.insertion is not None:
        return Branch.INSERTED
    return Branch.EMPTY if inquiry.told(GuideStated).guide is GuideState.EMPTY else Branch.NOT_EMPTY


Chooser = Callable[[Inquiry, Verdicts], Branch]
_MOTION_ENDS = frozenset({Branch.LATE, Branch.ADRIFT, Branch.AT_REST})
_EVALUATED = frozenset({Branch.LATE, Branch.UNUSABLE, Branch.VIEW_MOVED, Branch.PATIENT_SHIFTED, Branch.EXCEEDED})
_CURRENT = frozenset({Branch.LATE, Branch.CURRENT})

# Every branch that a chooser can return: the table must have exactly one row for each, in every state.
CHOICES: dict[Trigger, tuple[Chooser, frozenset[Branch]]] = {
    Trigger.IMAGE_ARRIVED: (_image, frozenset({Branch.ACCEPTED, Branch.OTHERWISE})),
    Trigger.REGISTRATION_COMPLETED: (_registered, frozenset({Branch.LATE, Branch.SOUND, Branch.UNSOUND})),
    Trigger.REGISTRATION_REFUSED: (_not_registered, _CURRENT),
    Trigger.ARRIVED: (_arrived, frozenset({Branch.LATE, Branch.ADRIFT, Branch.AT_GOAL, Branch.ELSEWHERE})),
    Trigger.MISSED: (_ended, _MOTION_ENDS),
    Trigger.RELEASED: (_ended, _MOTION_ENDS),
    Trigger.VERIFICATION_PASSED: (_passed, _EVALUATED | {Branch.PASSED}),
    Trigger.VERIFICATION_FAILED: (_failed, _EVALUATED),
    Trigger.VERIFICATION_REFUSED: (_not_evaluated, _CURRENT),
    Trigger.INSERTION_CANCELLED: (_cancelled, frozenset({Branch.INSERTION_OPEN, Branch.INSERTION_NOT_OPEN})),
    Trigger.GUIDE_STATE_STATED: (_guide, frozenset({Branch.EMPTY, Branch.NOT_EMPTY, Branch.INSERTED})),
}
_ONLY_ALWAYS = frozenset({Branch.ALWAYS})


def branches_of(trigger: Trigger) -> frozenset[Branch]:
    """What a trigger can turn out to be."""
    return CHOICES[trigger][1] if trigger in CHOICES else _ONLY_ALWAYS


def choose(inquiry: Inquiry, verdicts: Verdicts) -> Branch:
    """What this one turns out to be."""
    return CHOICES[inquiry.trigger][0](inquiry, verdicts) if inquiry.trigger in CHOICES else Branch.ALWAYS

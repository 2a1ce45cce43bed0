"""What a row of the table does to the case: small steps from one frozen value to the next."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

from workflow.case import CaseState, Insertion, Motion, Plan, Verification, Window
from workflow.facts import (
    CarmPositionConfirmed,
    CorrectionRequested,
    Evaluated,
    ExposureRequested,
    GuideStated,
    ImageArrived,
    InsertionStarted,
    LeaseTaken,
    MotionEnded,
    MoveStarted,
    NewestImageReused,
    PlanRequested,
    RegistrationCompleted,
    SleeveIn,
    TargetConfirmed,
)
from workflow.inquiry import Inquiry
from workflow.interlocks import CLEAN_IMAGE
from workflow.links import Artefact, Link
from workflow.motion_interlocks import input_ids
from workflow.permits import issue
from workflow.states import GuideState, InsertionStatus

Change = Callable[[CaseState, Inquiry], CaseState]


def without(case: CaseState, link: Link) -> CaseState:
    """The case with a link and everything below it void."""
    void: dict[str, Any] = {below.value: None for below in link.with_below}
    # An evaluation under way judges a motion that is void now.
    return replace(case, **void, evaluated_image=None)


def void_from(link: Link) -> Change:
    """Void a link and everything below it."""
    return lambda case, _: without(case, link)


def void_view_keeping_passed(case: CaseState, _: Inquiry) -> CaseState:
    """A turned C-arm sees something else, but a guide that was verified still points where it did."""
    verification = case.verification
    case = without(case, Link.VIEW)
    return replace(case, verification=verification if verification and verification.passed else None)


def void_verification(case: CaseState, _: Inquiry) -> CaseState:
    """The guide is judged anew; motion and aim stay."""
    return replace(case, verification=None)


def forget_images(case: CaseState, _: Inquiry) -> CaseState:
    """Something moved: the newest image, or one that is still on its way, shows what is no longer there."""
    return replace(case, newest_image_id=None, window=None)


def new_view(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The C-arm stands somewhere: whatever was seen or asked for from elsewhere is void."""
    facts = inquiry.told(CarmPositionConfirmed)
    return replace(without(case, Link.VIEW), view=Artefact(facts.view_id, ()), window=None, newest_image_id=None)


def open_window(case: CaseState, inquiry: Inquiry) -> CaseState:
    """Latch the joints and the motion that the image will show."""
    window = Window(
        id=inquiry.told(ExposureRequested).window_id,
        opened_s=inquiry.now_s,
        joints_rad=inquiry.snapshot.joints_rad.value or (),
        motion_id=case.motion.id if case.motion else None,
    )
    return replace(case, window=window)


def count_image(case: CaseState, _: Inquiry) -> CaseState:
    """Every image counts, whatever becomes of it."""
    return replace(case, images=case.images + 1)


def remember_image(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The newest image that shows what is there."""
    return replace(case, newest_image_id=inquiry.told(ImageArrived).image_id)


def remember_clean_image(case: CaseState, inquiry: Inquiry) -> CaseState:
    """An image that nobody asked for may be reused if it is this patient's, new and sharp."""
    clean = all(lock.judge(inquiry).passed for lock in CLEAN_IMAGE)
    return remember_image(case, inquiry) if clean else case


def _image(case: CaseState, image_id: str) -> CaseState:
    view_id = case.view.id if case.view else ""
    return replace(case, image=Artefact(image_id, (view_id,)))


def new_image(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The arrived image enters the chain."""
    return _image(case, inquiry.told(ImageArrived).image_id)


def reuse_image(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The newest image enters the chain again."""
    return _image(case, inquiry.told(NewestImageReused).image_id)


def evaluate_image(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The arrived image is to verify the completed motion."""
    motion_id = case.motion.id if case.motion else ""
    image = Artefact(inquiry.told(ImageArrived).image_id, (motion_id,))
    return replace(case, evaluated_image=image, window=None)


def new_registration(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The guide was found in the image."""
    facts = inquiry.told(RegistrationCompleted)
    return replace(case, registration=Artefact(facts.registration_id, (facts.image_id,)))


def new_target(case: CaseState, inquiry: Inquiry) -> CaseState:
    """A target, and nothing planned for it yet."""
    facts = inquiry.told(TargetConfirmed)
    target = Artefact(facts.target_id, (facts.image_id, facts.registration_id))
    return replace(without(case, Link.PLAN), target=target, corrections=0)


def withdraw_target(case: CaseState, _: Inquiry) -> CaseState:
    """No target, and no count of its corrections."""
    return replace(without(case, Link.TARGET), corrections=0)


def correct(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The verification image takes the place of the image that the move was planned from."""
    facts, view_id = inquiry.told(CorrectionRequested), case.view.id if case.view else ""
    return replace(
        without(case, Link.PLAN),
        image=Artefact(facts.image_id, (view_id,)),
        registration=Artefact(facts.registration_id, (facts.image_id,)),
        target=Artefact(facts.target_id, (facts.image_id, facts.registration_id)),
        corrections=case.corrections + 1,
    )


def new_plan(case: CaseState, inquiry: Inquiry) -> CaseState:
    """A plan, not yet approved."""
    facts = inquiry.told(PlanRequested)
    plan = Plan(
        id=facts.plan_id,
        made_from=tuple(id_ for id_ in input_ids(case, facts.kind) if id_),
        kind=facts.kind,
        axial=facts.axial,
        start_joints_rad=facts.start_joints_rad,
        used=False,
        predicted_angle_rad=facts.predicted_angle_rad,
        predicted_position_mm=facts.predicted_position_mm,
    )
    # The motion and its verification were made from the plan before this one; they end when the arm starts to move.
    return replace(case, plan=plan, permit=None)


def new_permit(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The surgeon approved the plan."""
    return replace(case, permit=issue(inquiry))


def start_motion(case: CaseState, inquiry: Inquiry) -> CaseState:
    """Consume the permit and the plan; what the arm pointed at no longer counts.

    Raises
    ------
    ValueError
        If there is no plan or permit.
    """
    facts, plan, permit = inquiry.told(MoveStarted), case.plan, case.permit
    if plan is None or permit is None:
        raise ValueError("a motion starts from a plan and a permit")
    return replace(
        without(case, Link.MOTION),
        plan=replace(plan, used=True),
        permit=None,
        used_permit_id=permit.id,
        running=Motion(facts.motion_id, (plan.id, permit.id), plan.kind),
    )


def complete_motion(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The arm is at rest where the target asked for it.

    Raises
    ------
    ValueError
        If this motion is not under way.
    """
    facts, running = inquiry.told(MotionEnded), case.running
    if running is None or running.id != facts.motion_id:
        raise ValueError(f"motion {facts.motion_id} is not under way")
    return replace(case, motion=running, running=None)


def close_motion(case: CaseState, _: Inquiry) -> CaseState:
    """Ended elsewhere, or interrupted: nothing can be verified, nothing resumed."""
    return replace(case, running=None)


def new_verification(case: CaseState, inquiry: Inquiry, passed: bool) -> CaseState:
    """A verdict on the completed motion, from the image that was evaluated."""
    facts, motion_id = inquiry.told(Evaluated), case.motion.id if case.motion else ""
    verification = Verification(
        id=facts.evaluation_id,
        made_from=(facts.image_id, motion_id),
        image_id=facts.image_id,
        motion_id=motion_id,
        passed=passed,
        judged_s=inquiry.now_s,
    )
    return replace(case, verification=verification, evaluated_image=None)


def pass_verification(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The guide points at the target."""
    return new_verification(case, inquiry, passed=True)


def fail_verification(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The guide points beside the target."""
    return new_verification(case, inquiry, passed=False)


def drop_evaluation(case: CaseState, _: Inquiry) -> CaseState:
    """The image could not be judged; another may be asked for."""
    return replace(case, evaluated_image=None)


def open_insertion(case: CaseState, inquiry: Inquiry) -> CaseState:
    """From now on the guide is not empty."""
    id_ = inquiry.told(InsertionStarted).insertion_id
    insertion = Insertion(id_, InsertionStatus.OPEN, verified=False, flagged=False)
    return replace(case, insertion=insertion, guide=GuideState.INSTRUMENT)


def _inserted(case: CaseState, inquiry: Inquiry, verified: bool) -> CaseState:
    before, id_ = case.insertion, inquiry.told(SleeveIn).insertion_id
    done = Insertion(
        id=before.id if before else id_,
        status=InsertionStatus.DONE,
        verified=verified,
        flagged=before.flagged if before else False,
    )
    return replace(case, insertion=done, guide=GuideState.INSTRUMENT)


def finish_insertion(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The sleeve is in; said again, it stays as verified as it was."""
    before = case.insertion
    again = before is not None and before.status is InsertionStatus.DONE
    passed = case.verification is not None and case.verification.passed
    return _inserted(case, inquiry, verified=before.verified if before and again else passed)


def finish_unverified(case: CaseState, inquiry: Inquiry) -> CaseState:
    """A sleeve where none was expected: nothing says where it points."""
    return _inserted(case, inquiry, verified=False)


def cancel_insertion(case: CaseState, _: Inquiry) -> CaseState:
    """Nothing went in."""
    return replace(case, insertion=None, guide=GuideState.EMPTY)


def archive_insertion(case: CaseState, inquiry: Inquiry) -> CaseState:
    """The attempt is over; the aim goes with it, the registration stays."""
    return replace(withdraw_target(case, inquiry), insertion=None)


def flag_insertion(case: CaseState, _: Inquiry) -> CaseState:
    """Something moved or changed while the sleeve was in."""
    return replace(case, insertion=replace(case.insertion, flagged=True) if case.insertion else None)


def state_guide(case: CaseState, inquiry: Inquiry) -> CaseState:
    """A person says what is in the guide."""
    return replace(case, guide=inquiry.told(GuideStated).guide)


def take_lease(case: CaseState, inquiry: Inquiry) -> CaseState:
    """Control goes to the newest fencing token."""
    return replace(case, control_token=inquiry.told(LeaseTaken).control_token)

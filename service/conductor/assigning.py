"""A person says what an image is for that the procedure did not take (H01): never that it is of the chain."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Annotated, Any

from fastapi import APIRouter, Depends

from service.auth.permissions import Permission
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact
from service.conductor.answers import CommandAnswer
from service.conductor.arrival import facts_of
from service.conductor.bodies import AssignImage
from service.conductor.caller import Caller, stating
from service.conductor.conductor import Conductor, TheConductor, new_id
from service.conductor.route_errors import ASSIGNING_AN_IMAGE
from service.conductor.taking import Prepared, Standing
from service.conductor.verdict_json import verdict_json
from service.errors import ErrorCode, ServiceError
from service.images.assignments import count_assignments
from service.images.store import NewPurpose, StoredImage, purpose_of, read_image
from workflow.decisions import ImageUse
from workflow.facts import Paper
from workflow.inquiry import Inquiry
from workflow.interlocks import UNSEEN, provenance
from workflow.refusals import RefusalCode
from workflow.triggers import Trigger
from workflow.verdicts import Verdict

router = APIRouter(tags=["images of a case"])
Assigner = Annotated[Caller, Depends(stating(Permission.EXPOSE))]
# An image enters the chain by arriving in an exposure that was asked for, with the arm's pose latched, and never later.
_ASSIGNABLE = (ImageUse.SCOUT, ImageUse.DEPTH_CHECK, ImageUse.QUARANTINED)
_UNSEEN = frozenset(lock.code for lock in UNSEEN)


@router.post("/cases/{case_id}/image-assigned", openapi_extra=ASSIGNING_AN_IMAGE)
def image_assigned(body: AssignImage, caller: Assigner, conductor: TheConductor) -> CommandAnswer:
    """A scout or a depth check of this case, or back to quarantine; a record of its own beside the image's arrival.

    One that is quarantined or in no case needs a reason and the patient's id: it names somebody else, or came before.
    What was checked on its arrival is checked anew, against this case.
    """

    def prepare(standing: Standing) -> Prepared:
        image = read_image(standing.connection, body.image_id)
        given = _refuse_unfit(standing, image, body)
        verdicts = _checked(conductor, standing, image)
        content = {
            "purpose": body.purpose,
            "before": {"purpose": given.purpose, "case_id": given.case_id},
            "reason": body.reason,
            "patient_id": body.patient_id,
            "user_id": caller.session.user_id,
            "verdicts": [asdict(verdict) for verdict in verdicts],
        }
        columns = {"image_id": image.id, "number": count_assignments(standing.connection, image.id) + 1}
        made = NewArtefact(ArtefactKind.IMAGE_ASSIGNMENT, new_id(), (image.id,), content, columns)
        data = {"image_id": image.id, "purpose": body.purpose, "reason": body.reason}
        return Prepared(Paper(permitted=True), (made,), {"image_assignment": made.id}, data)

    return conductor.perform(caller, Trigger.LABEL, prepare)


def _refuse_unfit(standing: Standing, image: StoredImage, body: AssignImage) -> NewPurpose:
    """What the image was for so far; ServiceError where a person cannot say that it is for this."""
    given = purpose_of(standing.connection, image.id)
    if given is None:
        raise ServiceError(ErrorCode.PURPOSE_UNDECIDED, "nobody has decided yet what the image is for")
    if image.problem is not None:
        raise _as_it_arrived(image.problem)
    if body.purpose not in _ASSIGNABLE or given.purpose in (ImageUse.REGISTRATION, ImageUse.VERIFICATION):
        message = f"an image that is for {given.purpose} is not made one for {body.purpose}"
        raise ServiceError(
            ErrorCode.PURPOSE_REFUSED, message, measured=body.purpose, limit=", ".join(map(str, _ASSIGNABLE))
        )
    foreign = given.purpose == ImageUse.QUARANTINED or given.case_id is None
    if not foreign and given.case_id != standing.case.case_id:
        raise ServiceError(ErrorCode.IMAGE_TAKEN_IN, f"the image belongs to case {given.case_id}")
    if foreign:
        _refuse_unsaid(standing, given, body)
    if body.purpose is ImageUse.QUARANTINED and not body.reason:
        raise ServiceError(RefusalCode.REASON_REQUIRED, "an image is withdrawn with a reason")
    return given


def _refuse_unsaid(standing: Standing, given: NewPurpose, body: AssignImage) -> None:
    if body.purpose is ImageUse.QUARANTINED:
        message = "the image is in no case that it could be withdrawn from"
        raise ServiceError(ErrorCode.PURPOSE_REFUSED, message, measured=body.purpose, limit=given.purpose)
    if not body.reason:
        raise ServiceError(RefusalCode.REASON_REQUIRED, "an image of another patient, or of none, needs a reason")
    if body.patient_id != store.read_case(standing.connection, standing.case.case_id).patient_id:
        raise ServiceError(ErrorCode.PATIENT_DIFFERS, "the patient that is named is not the patient of this case")


def _as_it_arrived(problem: Mapping[str, Any]) -> ServiceError:
    return ServiceError(problem["code"], problem["message"], measured=problem["measured"], limit=problem["limit"])


def _checked(conductor: Conductor, standing: Standing, image: StoredImage) -> tuple[Verdict, ...]:
    """Every verdict on where the image comes from; ServiceError `interlock` where it came before, or is an old one.

    Whose it is the person says, and when it was taken where it does not say so itself.
    """
    facts = facts_of(standing, image, None)
    facts = replace(facts, newer_by_carm_clock=facts.newer_by_carm_clock is not False)
    rules = conductor.rules
    inquiry = Inquiry(standing.case, Trigger.IMAGE_ARRIVED, facts, standing.snapshot, rules.limits, rules.clock())
    verdicts = provenance(inquiry)
    failed = next((one for one in verdicts if not one.passed and one.code in _UNSEEN), None)
    if failed is not None:
        raise ServiceError(
            RefusalCode.INTERLOCK,
            failed.message,
            measured=failed.measured,
            limit=failed.limit,
            verdicts=[verdict_json(one) for one in verdicts],
        )
    return verdicts

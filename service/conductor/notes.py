"""Words for the record: they change nothing."""

from typing import Annotated

from fastapi import APIRouter, Depends

from service.auth.permissions import Permission
from service.conductor.answers import CommandAnswer
from service.conductor.bodies import LabelImage, WriteNote
from service.conductor.caller import Caller, stating
from service.conductor.conductor import TheConductor
from service.conductor.route_errors import STATING, STATING_ABOUT_AN_IMAGE
from service.conductor.taking import Prepared
from service.images.store import read_image
from workflow.facts import Paper
from workflow.triggers import Trigger

router = APIRouter(tags=["notes of a case"])
Writer = Annotated[Caller, Depends(stating(Permission.NOTE))]


@router.post("/cases/{case_id}/note", openapi_extra=STATING)
def note(body: WriteNote, caller: Writer, conductor: TheConductor) -> CommandAnswer:
    """A remark."""
    return conductor.perform(caller, Trigger.NOTE, lambda _: Prepared(Paper(permitted=True), data={"text": body.text}))


@router.post("/cases/{case_id}/label", openapi_extra=STATING_ABOUT_AN_IMAGE)
def label(body: LabelImage, caller: Writer, conductor: TheConductor) -> CommandAnswer:
    """A word on an image, which changes nothing; ServiceError IMAGE_UNKNOWN."""
    with conductor.parts.database.read() as connection:
        read_image(connection, body.image_id)
    prepared = Prepared(Paper(permitted=True), data={"image_id": body.image_id, "label": body.label})
    return conductor.perform(caller, Trigger.LABEL, lambda _: prepared)

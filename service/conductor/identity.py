"""A person states whose an image is that does not say so itself, and what it shows."""

from typing import Annotated

from fastapi import APIRouter, Depends

from service.auth.permissions import Permission
from service.conductor.answering import answer_of
from service.conductor.answers import CommandAnswer
from service.conductor.arrival import Statement, take_in_stated
from service.conductor.bodies import StateIdentity
from service.conductor.caller import Caller, stating
from service.conductor.conductor import TheConductor
from service.conductor.route_errors import STATING_AN_IDENTITY

router = APIRouter(tags=["images of a case"])


@router.post("/cases/{case_id}/image-identity-stated", openapi_extra=STATING_AN_IDENTITY)
def image_identity_stated(
    body: StateIdentity, caller: Annotated[Caller, Depends(stating(Permission.EXPOSE))], conductor: TheConductor
) -> CommandAnswer:
    """The image is of this patient, in this view, of this exposure: it arrives in the case as one from the C-arm does.

    Its pixels must be new; with another patient, or with pixels that came before, it is quarantined. A purpose that is
    stated and is not what the procedure makes of it is refused.
    """
    statement = Statement(body.patient_id, body.view_id, body.window_id, body.purpose, caller.session.user_id)
    return answer_of(take_in_stated(conductor, caller.case_id, body.image_id, statement))

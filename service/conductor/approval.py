"""The surgeon's approval of one plan: a single-use permit, with every interlock's measured value and limit."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends
from sqlalchemy.engine import Connection

from service.auth.permissions import Permission, Role
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact
from service.conductor.answers import CommandAnswer
from service.conductor.bodies import ApproveMove
from service.conductor.caller import Caller, requesting
from service.conductor.conductor import Conductor, TheConductor, new_id
from service.conductor.route_errors import APPROVING
from service.conductor.taking import Prepared, Standing
from workflow.facts import Approval, MoveApproved
from workflow.triggers import Trigger

router = APIRouter(tags=["motions of a case"])


@router.post("/cases/{case_id}/move-approved", openapi_extra=APPROVING)
def move_approved(
    body: ApproveMove, caller: Annotated[Caller, Depends(requesting(Permission.APPROVE))], conductor: TheConductor
) -> CommandAnswer:
    """Approve the newest plan with the PIN: the permit lives for seconds and is good for one held motion."""
    approval = confirmed_approval(conductor, caller, body.pin)

    def prepare(standing: Standing) -> Prepared:
        facts = MoveApproved(new_id(), body.plan_id, approval, caller.overriding(body.overrides))
        plan = standing.case.plan
        made_from = (plan.id, *plan.made_from) if plan is not None else ()
        content = {
            "plan_id": body.plan_id,
            "control_token": approval.control_token,
            "life_s": conductor.rules.limits.permit_life_s,
            "overrides": body.overrides,
            "detectable_motion": _detectable(standing.connection, plan.id) if plan is not None else None,
        }
        columns = {"approved_by": caller.session.user_id}
        permit = NewArtefact(ArtefactKind.PERMIT, facts.permit_id, made_from, content, columns)
        data = {name: content[name] for name in ("plan_id", "detectable_motion", "overrides")}
        return Prepared(facts, (permit,), {"permit": facts.permit_id}, data, content)

    return conductor.perform(caller, Trigger.MOVE_APPROVED, prepare)


def _detectable(connection: Connection, plan_id: str) -> Any:
    """What the image after the motion will see to have moved (H03): told and recorded with the approval."""
    return store.read_artefact(connection, ArtefactKind.PLAN, plan_id).content["detectable_motion"]


def confirmed_approval(conductor: Conductor, caller: Caller, pin: str) -> Approval:
    """Who approves, their PIN proved with this very request; ServiceError PIN_REFUSED or LOCKED_OUT."""
    conductor.parts.proofs.confirm_pin(caller.session, pin)
    return Approval(
        person_id=caller.session.user_id,
        surgeon=caller.session.role is Role.SURGEON,
        pin_confirmed=True,
        control_token=-1 if caller.control_token is None else caller.control_token,
    )

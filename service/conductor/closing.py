"""The end of a case: closed with every target accounted for and signed, or aborted."""

from typing import Annotated

from fastapi import APIRouter, Depends

from service.auth.permissions import Permission
from service.conductor.answers import CommandAnswer
from service.conductor.bodies import CloseCase, WithReason
from service.conductor.caller import Caller, requesting, stating
from service.conductor.conductor import TheConductor
from service.conductor.route_errors import CLOSING, STATING
from service.conductor.statements import state_only
from service.conductor.taking import Prepared, Standing
from service.conductor.target_list import target_states
from workflow.facts import CaseClosed, Reasoned
from workflow.triggers import Trigger

router = APIRouter(tags=["end of a case"])


@router.post("/cases/{case_id}/case-closed", openapi_extra=CLOSING)
def case_closed(
    body: CloseCase, caller: Annotated[Caller, Depends(requesting(Permission.CLOSE_CASE))], conductor: TheConductor
) -> CommandAnswer:
    """Close: each planned target was placed, or is abandoned here with a reason; the PIN signs."""
    conductor.parts.proofs.confirm_pin(caller.session, body.pin)

    def prepare(standing: Standing) -> Prepared:
        states = target_states(standing.connection, caller.case_id)
        open_targets = [name for name, state in states.items() if state == "open" and name not in body.abandoned]
        data = {"abandoned": dict(body.abandoned), "targets": states, "signed_by": caller.session.user_id}
        return Prepared(CaseClosed(len(open_targets)), data=data, detail={"open_targets": open_targets})

    return conductor.perform(caller, Trigger.CASE_CLOSED, prepare)


@router.post("/cases/{case_id}/case-aborted", openapi_extra=STATING)
def case_aborted(
    body: WithReason, caller: Annotated[Caller, Depends(stating(Permission.CLOSE_CASE))], conductor: TheConductor
) -> CommandAnswer:
    """Abort: the arm is stopped, whatever it does."""
    return state_only(conductor, caller, Trigger.CASE_ABORTED, Reasoned(body.reason), reason=body.reason)

"""Control of a case: the lease, the pause, and the way out of a hold."""

from typing import Annotated

from fastapi import APIRouter, Depends
from sqlalchemy.engine import Connection

from service.auth.lease import take_lease
from service.auth.permissions import Permission, Role
from service.conductor.answers import CommandAnswer
from service.conductor.bodies import Acknowledge, WithReason
from service.conductor.caller import Caller, requesting
from service.conductor.conductor import Conductor, TheConductor
from service.conductor.route_errors import REQUESTING
from service.conductor.stopping import perform_stopped
from service.conductor.taking import Prepared, Standing
from workflow.decisions import Decision
from workflow.facts import Acknowledged, LeaseTaken, Reasoned
from workflow.triggers import Trigger

router = APIRouter(tags=["control of a case"])


@router.post("/cases/{case_id}/lease-taken", openapi_extra=REQUESTING)
def lease_taken(
    body: WithReason, caller: Annotated[Caller, Depends(requesting(Permission.TAKE_LEASE))], conductor: TheConductor
) -> CommandAnswer:
    """Take control, from whoever has it; an arm that moves is stopped first. The token outdates every earlier one."""

    def prepare(standing: Standing) -> Prepared:
        return _lease(conductor, caller, standing, body.reason)

    if conductor.bridge.is_moving():
        return perform_stopped(conductor, caller, Trigger.LEASE_TAKEN, prepare, "control was taken")
    return conductor.perform(caller, Trigger.LEASE_TAKEN, prepare)


@router.post("/cases/{case_id}/hold-requested", openapi_extra=REQUESTING)
def hold_requested(
    body: WithReason, caller: Annotated[Caller, Depends(requesting(Permission.HOLD))], conductor: TheConductor
) -> CommandAnswer:
    """Pause: nothing is void but the permit, and ages run on."""
    prepared = Prepared(Reasoned(body.reason), data={"reason": body.reason})
    return conductor.perform(caller, Trigger.HOLD_REQUESTED, lambda _: prepared)


@router.post("/cases/{case_id}/acknowledged", openapi_extra=REQUESTING)
def acknowledged(
    body: Acknowledge, caller: Annotated[Caller, Depends(requesting(Permission.APPROVE))], conductor: TheConductor
) -> CommandAnswer:
    """A surgeon looked: the cause is gone, the arm at rest, and this is in the guide. Nothing resumes by itself."""
    facts = Acknowledged(surgeon=caller.session.role is Role.SURGEON, guide=body.guide)
    return conductor.perform(caller, Trigger.ACKNOWLEDGED, lambda _: Prepared(facts, data={"guide": body.guide}))


def _lease(conductor: Conductor, caller: Caller, standing: Standing, reason: str) -> Prepared:
    token = (standing.lease.fencing_token if standing.lease else 0) + 1

    def unlock(_: Decision) -> None:
        # A guard starts locked; whoever first takes control of a calm case has looked at the arm. One that does not
        # take this holds the case by its fault, and control is taken all the same.
        conductor.unlock()

    def write(connection: Connection, _: Decision) -> None:
        take_lease(connection, caller.case_id, caller.session, reason)

    facts = LeaseTaken(token, reason)
    data = {"control_token": token, "reason": reason}
    return Prepared(facts, data=data, detail={"control_token": token}, then=unlock, also=write)

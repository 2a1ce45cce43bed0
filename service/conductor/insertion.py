"""The sleeve: insertion with the arm locked, what a person says of it, and the end of the attempt."""

import time
from typing import Annotated

from fastapi import APIRouter, Depends

from robot.guard.messages import Phase
from service.auth.permissions import Permission
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact
from service.conductor.answers import CommandAnswer
from service.conductor.approval import confirmed_approval
from service.conductor.bodies import FinishTarget, Nothing, RemoveSleeve, WithOptionalReason, WithPin
from service.conductor.caller import Caller, requesting, stating
from service.conductor.conductor import Conductor, TheConductor, new_id
from service.conductor.route_errors import APPROVING, REQUESTING, STATING
from service.conductor.statements import state, state_only
from service.conductor.taking import Prepared, Standing
from service.errors import ServiceError
from workflow.facts import Approval, GuideStated, InsertionStarted, Reasoned, SleeveIn, TargetDone
from workflow.states import State
from workflow.triggers import Trigger

router = APIRouter(tags=["insertion in a case"])
Speaker = Annotated[Caller, Depends(stating(Permission.STATE_FACT))]
_LOCK_WITHIN_S = 1.0
_LOOK_EVERY_S = 0.01


@router.post("/cases/{case_id}/insertion-started", openapi_extra=APPROVING)
def insertion_started(
    body: WithPin, caller: Annotated[Caller, Depends(requesting(Permission.APPROVE))], conductor: TheConductor
) -> CommandAnswer:
    """The surgeon is about to push the sleeve in: the guard is locked first, and its lock is an interlock (H29)."""
    approval = confirmed_approval(conductor, caller, body.pin)
    locked_here = _lock(conductor, caller.case_id)
    try:
        return conductor.perform(caller, Trigger.INSERTION_STARTED, lambda standing: _opened(standing, approval))
    except ServiceError:
        if locked_here:
            conductor.unlock()  # nothing was started: the lock that was only taken for it goes
        raise


@router.post("/cases/{case_id}/sleeve-in", openapi_extra=STATING)
def sleeve_in(_: Nothing, caller: Speaker, conductor: TheConductor) -> CommandAnswer:
    """The sleeve is in."""
    facts = SleeveIn(new_id())

    def prepare(standing: Standing) -> Prepared:
        if standing.case.insertion is not None:
            return Prepared(facts, made={"insertion": standing.case.insertion.id})
        artefact = _insertion(standing, facts.insertion_id)
        return Prepared(facts, (artefact,), {"insertion": facts.insertion_id})

    return state(conductor, caller, Trigger.SLEEVE_IN, facts, prepare)


@router.post("/cases/{case_id}/insertion-cancelled", openapi_extra=STATING)
def insertion_cancelled(body: WithOptionalReason, caller: Speaker, conductor: TheConductor) -> CommandAnswer:
    """The sleeve was not pushed in, and nothing is in the guide."""
    facts = Reasoned(body.reason)
    return state_only(conductor, caller, Trigger.INSERTION_CANCELLED, facts, reason=body.reason)


@router.post("/cases/{case_id}/sleeve-removed", openapi_extra=STATING)
def sleeve_removed(body: RemoveSleeve, caller: Speaker, conductor: TheConductor) -> CommandAnswer:
    """The sleeve is out of the guide: empty now, or a wire is left in."""
    return state_only(conductor, caller, Trigger.SLEEVE_REMOVED, GuideStated(body.guide), guide=body.guide)


@router.post("/cases/{case_id}/target-done", openapi_extra=REQUESTING)
def target_done(
    body: FinishTarget, caller: Annotated[Caller, Depends(requesting(Permission.TARGET))], conductor: TheConductor
) -> CommandAnswer:
    """The attempt is over: placed, or abandoned with a reason."""

    def prepare(standing: Standing) -> Prepared:
        data = {"placed": body.placed, "reason": body.reason, "planned_target": _planned_target(standing)}
        return Prepared(TargetDone(body.placed, body.reason), data=data, detail=data)

    return conductor.perform(caller, Trigger.TARGET_DONE, prepare)


def _lock(conductor: Conductor, case_id: str) -> bool:
    """Lock the guard, if the case waits for an insertion and nothing moves; whether it is locked by this."""
    with conductor.parts.database.read() as connection:
        waits = store.newest_event(connection, case_id).state == State.VERIFIED
    if not waits or conductor.bridge.is_moving() or _is_locked(conductor):
        return False
    conductor.bridge.stop("locked for an insertion")
    end_s = time.monotonic() + _LOCK_WITHIN_S
    while not _is_locked(conductor) and time.monotonic() < end_s:
        time.sleep(_LOOK_EVERY_S)
    return True


def _is_locked(conductor: Conductor) -> bool:
    status = conductor.bridge.status
    return status is not None and status.phase is Phase.HELD


def _opened(standing: Standing, approval: Approval) -> Prepared:
    facts = InsertionStarted(new_id(), approval)
    return Prepared(facts, (_insertion(standing, facts.insertion_id),), {"insertion": facts.insertion_id})


def _insertion(standing: Standing, insertion_id: str) -> NewArtefact:
    """An insertion with the target and the verification that it relies on, as they are known now."""
    case = standing.case
    made_from = tuple(one.id for one in (case.target, case.motion, case.verification) if one is not None)
    content = {
        "target_id": case.target.id if case.target else None,
        "verification_id": case.verification.id if case.verification else None,
        "planned_target": _target_name(standing),
    }
    return NewArtefact(ArtefactKind.INSERTION, insertion_id, made_from, content, {})


def _target_name(standing: Standing) -> str | None:
    """The planned target of the newest target, void or not: the C-arm is often turned away before the insertion."""
    targets = store.artefacts_of(standing.connection, ArtefactKind.TARGET, standing.case.case_id)
    return targets[-1].content["planned_target"] if targets else None


def _planned_target(standing: Standing) -> str | None:
    insertion = standing.case.insertion
    if insertion is None:
        return None
    name: str | None = store.read_artefact(standing.connection, ArtefactKind.INSERTION, insertion.id).content[
        "planned_target"
    ]
    return name

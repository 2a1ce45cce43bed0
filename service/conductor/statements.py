"""What a person states: it is never refused, and where it stops the arm, the stop goes out before the record."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends

from service.auth.permissions import Permission
from service.conductor.answers import CommandAnswer
from service.conductor.bodies import ChangeDevices, StateGuide, StateMovement
from service.conductor.caller import Caller, stating
from service.conductor.conductor import Conductor, TheConductor
from service.conductor.device_set import device_ids, read_devices
from service.conductor.route_errors import STATING, STATING_ABOUT_A_FILE
from service.conductor.stopping import perform_stopped
from service.conductor.taking import Prepare, Prepared
from workflow.facts import Facts, GuideStated, Movement
from workflow.triggers import Trigger

router = APIRouter(tags=["statements about a case"])
Speaker = Annotated[Caller, Depends(stating(Permission.STATE_FACT))]


def state(conductor: Conductor, caller: Caller, trigger: Trigger, facts: Facts, prepare: Prepare) -> CommandAnswer:
    """Record a fact; the arm is stopped first if the fact says that it must stand."""
    if not conductor.would_stop(caller.case_id, trigger, facts):
        return conductor.perform(caller, trigger, prepare)
    return perform_stopped(conductor, caller, trigger, prepare, f"stated: {trigger}")


def state_only(conductor: Conductor, caller: Caller, trigger: Trigger, facts: Facts, **data: Any) -> CommandAnswer:
    """Record a fact that makes nothing."""
    return state(conductor, caller, trigger, facts, lambda _: Prepared(facts, data=data))


@router.post("/cases/{case_id}/guide-state-stated", openapi_extra=STATING)
def guide_state_stated(body: StateGuide, caller: Speaker, conductor: TheConductor) -> CommandAnswer:
    """What is in the guide's bore; unknown counts as an instrument (H35)."""
    return state_only(conductor, caller, Trigger.GUIDE_STATE_STATED, GuideStated(body.guide), guide=body.guide)


@router.post("/cases/{case_id}/carm-moved", openapi_extra=STATING)
def carm_moved(body: StateMovement, caller: Speaker, conductor: TheConductor) -> CommandAnswer:
    """The C-arm was moved: what is planned from its view is void, a passed verification stands."""
    return _moved(conductor, caller, Trigger.CARM_MOVED, body)


@router.post("/cases/{case_id}/patient-moved", openapi_extra=STATING)
def patient_moved(body: StateMovement, caller: Speaker, conductor: TheConductor) -> CommandAnswer:
    """The patient moved: image and everything below it are void."""
    return _moved(conductor, caller, Trigger.PATIENT_MOVED, body)


@router.post("/cases/{case_id}/hand-guided", openapi_extra=STATING)
def hand_guided(body: StateMovement, caller: Speaker, conductor: TheConductor) -> CommandAnswer:
    """The arm was moved by hand: image and everything below it are void."""
    return _moved(conductor, caller, Trigger.HAND_GUIDED, body)


@router.post("/cases/{case_id}/device-changed", openapi_extra=STATING_ABOUT_A_FILE)
def device_changed(body: ChangeDevices, caller: Speaker, conductor: TheConductor) -> CommandAnswer:
    """Other device files from now on; ServiceError DEVICE_UNKNOWN where there is no such file."""
    with conductor.parts.database.read() as connection:
        read_devices(connection, device_ids(connection, caller.case_id) | dict(body.devices))
    facts = Movement(observed=False, what=body.what)
    devices = dict(body.devices)
    return state_only(conductor, caller, Trigger.DEVICE_CHANGED, facts, devices=devices, what=body.what)


def _moved(conductor: Conductor, caller: Caller, trigger: Trigger, body: StateMovement) -> CommandAnswer:
    return state_only(conductor, caller, trigger, Movement(observed=False, what=body.what), what=body.what)

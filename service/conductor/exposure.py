"""Positioning and exposing: the C-arm stands, an exposure is about to be made, an image is taken again."""

import asyncio
from typing import Annotated

from fastapi import APIRouter, Depends

from service.auth.permissions import Permission
from service.conductor.answers import CommandAnswer
from service.conductor.bodies import ImageAgain, Nothing, WithReason
from service.conductor.caller import Caller, requesting
from service.conductor.conductor import Conductor, TheConductor, new_id
from service.conductor.image_work import guide_in_image
from service.conductor.route_errors import REQUESTING, REUSING_AN_IMAGE
from service.conductor.taking import Prepared, Standing
from workflow.facts import CarmPositionConfirmed, ExposureRequested, NewestImageReused, Reasoned
from workflow.triggers import Trigger

router = APIRouter(tags=["images of a case"])
Positioner = Annotated[Caller, Depends(requesting(Permission.POSITION_CARM))]
Exposer = Annotated[Caller, Depends(requesting(Permission.EXPOSE))]


@router.post("/cases/{case_id}/carm-position-confirmed", openapi_extra=REQUESTING)
def carm_position_confirmed(_: Nothing, caller: Positioner, conductor: TheConductor) -> CommandAnswer:
    """The C-arm stands where the next image is to be taken: a new view."""

    def prepare(_: Standing) -> Prepared:
        view_id = new_id()
        return Prepared(CarmPositionConfirmed(view_id), made={"view": view_id})

    return conductor.perform(caller, Trigger.CARM_POSITION_CONFIRMED, prepare)


@router.post("/cases/{case_id}/exposure-requested", openapi_extra=REQUESTING)
def exposure_requested(_: Nothing, caller: Exposer, conductor: TheConductor) -> CommandAnswer:
    """An exposure is about to be made: for some time, one arriving image of this patient enters the chain.

    The arm's pose is latched before the request is recorded, so that no image can arrive without one.
    """

    def prepare(_: Standing) -> Prepared:
        window_id = new_id()
        arm = conductor.bridge.watch.open_exposure(window_id)
        data = {"base_from_tcp": arm.base_from_tcp.tolist()} if arm is not None else {}
        detail = {"window_s": conductor.rules.limits.exposure_window_s}
        return Prepared(ExposureRequested(window_id), made={"window": window_id}, data=data, detail=detail)

    return conductor.perform(caller, Trigger.EXPOSURE_REQUESTED, prepare)


@router.post("/cases/{case_id}/newest-image-reused", openapi_extra=REUSING_AN_IMAGE)
async def newest_image_reused(body: ImageAgain, caller: Exposer, conductor: TheConductor) -> CommandAnswer:
    """Take the newest image again instead of exposing; the guide must be in it and nothing may have moved since."""
    found = await guide_in_image(conductor, caller.case_id, body.image_id)
    return await asyncio.to_thread(_reuse, conductor, caller, NewestImageReused(body.image_id, found))


def _reuse(conductor: Conductor, caller: Caller, facts: NewestImageReused) -> CommandAnswer:
    def prepare(_: Standing) -> Prepared:
        return Prepared(facts, made={"image": facts.image_id}, data={"image_id": facts.image_id})

    return conductor.perform(caller, Trigger.NEWEST_IMAGE_REUSED, prepare)


@router.post("/cases/{case_id}/retake", openapi_extra=REQUESTING)
def retake(body: WithReason, caller: Exposer, conductor: TheConductor) -> CommandAnswer:
    """The image is not good enough: it and all that was made from it are void."""

    def prepare(_: Standing) -> Prepared:
        return Prepared(Reasoned(body.reason), data={"reason": body.reason})

    return conductor.perform(caller, Trigger.RETAKE, prepare)

"""Choosing a target: the picked point is drawn back, seen, confirmed; or withdrawn."""

import asyncio
from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Depends

from service.auth.dependencies import require
from service.auth.permissions import Permission
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact
from service.conductor.answers import CommandAnswer, EchoAnswer
from service.conductor.bodies import ConfirmTarget, ImagePoint, WithReason
from service.conductor.caller import Caller, requesting
from service.conductor.conductor import Conductor, TheConductor, new_id
from service.conductor.echoes import Echo
from service.conductor.image_work import aim, draw_back, registration_json
from service.conductor.route_errors import AIMING, DRAWING_BACK
from service.conductor.taking import Prepared, Standing
from service.errors import ErrorCode, ServiceError
from workflow.case_json import from_json
from workflow.facts import Reasoned, TargetConfirmed
from workflow.triggers import Trigger

router = APIRouter(tags=["targets of a case"])
Chooser = Annotated[Caller, Depends(requesting(Permission.TARGET))]
_CHOOSER = [Depends(require(Permission.TARGET))]


@router.post(
    "/cases/{case_id}/target-echo", openapi_extra=DRAWING_BACK, dependencies=[Depends(require(Permission.TARGET))]
)
async def target_echo(case_id: str, body: ImagePoint, conductor: TheConductor) -> EchoAnswer:
    """The picked point as the server understood it; confirming a target needs the echo's id."""
    registration_id, registration = await asyncio.to_thread(_registration_of, conductor, case_id, body.image_id)
    drawn = await draw_back(conductor, body.image_id, registration, body.model_dump())
    echo = Echo(new_id(), case_id, body.image_id, registration_id, tuple(drawn["raw_px"]), tuple(drawn["corrected_px"]))
    conductor.echoes.remember(echo)
    return EchoAnswer(echo_id=echo.id, image_id=echo.image_id, registration_id=registration_id, **drawn)


@router.post("/cases/{case_id}/target-confirmed", openapi_extra=AIMING)
async def target_confirmed(body: ConfirmTarget, caller: Chooser, conductor: TheConductor) -> CommandAnswer:
    """The surgeon saw the echo and means it: a new target, and where the guide must go."""
    echo = conductor.echoes.find(caller.case_id, body.echo_id)
    if echo is None:
        facts = TargetConfirmed(new_id(), "", "", echo_seen=None)
        return await asyncio.to_thread(_confirm, conductor, caller, Prepared(facts))
    depth_mm = body.depth_mm or conductor.parts.settings.limits.depth_mm
    registration = await asyncio.to_thread(_read_registration, conductor, echo, body.planned_target)
    aimed = await aim(conductor, caller.case_id, registration, echo.raw_px, depth_mm)
    overrides = caller.overriding(body.overrides)
    facts = TargetConfirmed(new_id(), echo.image_id, echo.registration_id, echo_seen=True, overrides=overrides)
    target = target_artefact(facts.target_id, echo.image_id, echo.registration_id, aimed, depth_mm, body.planned_target)
    detail = {"targeting": aimed, "depth_mm": depth_mm, "planned_target": body.planned_target}
    data = {"echo_id": echo.id, "overrides": body.overrides}
    prepared = Prepared(facts, (target,), {"target": facts.target_id}, data, detail)
    return await asyncio.to_thread(_confirm, conductor, caller, prepared)


@router.post("/cases/{case_id}/target-withdrawn", openapi_extra=AIMING)
def target_withdrawn(body: WithReason, caller: Chooser, conductor: TheConductor) -> CommandAnswer:
    """The target is given up."""

    def prepare(_: Standing) -> Prepared:
        return Prepared(Reasoned(body.reason), data={"reason": body.reason})

    return conductor.perform(caller, Trigger.TARGET_WITHDRAWN, prepare)


def target_artefact(
    target_id: str,
    image_id: str,
    registration_id: str,
    aimed: Mapping[str, Any],
    depth_mm: float,
    planned_target: str | None,
) -> NewArtefact:
    """A target as it is recorded; the raw pixel is what crosses to other images."""
    content = {
        "image_id": image_id,
        "registration_id": registration_id,
        "planned_target": planned_target,
        "depth_mm": depth_mm,
        "raw_px": aimed["target_raw_px"],
        "targeting": dict(aimed),
    }
    return NewArtefact(ArtefactKind.TARGET, target_id, (image_id, registration_id), content, {})


def _confirm(conductor: Conductor, caller: Caller, prepared: Prepared) -> CommandAnswer:
    return conductor.perform(caller, Trigger.TARGET_CONFIRMED, lambda _: prepared)


def _registration_of(conductor: Conductor, case_id: str, image_id: str) -> tuple[str, dict[str, Any]]:
    """The registration in force; ServiceError IMAGE_NOT_REGISTERED if the point is in another image."""
    with conductor.parts.database.read() as connection:
        case = from_json(dict(store.newest_event(connection, case_id).case_state))
        if case.registration is None or case.image is None or case.image.id != image_id:
            raise ServiceError(ErrorCode.IMAGE_NOT_REGISTERED, "this image is not the registered one of the case")
        return case.registration.id, registration_json(connection, case.registration.id)


def _read_registration(conductor: Conductor, echo: Echo, planned_target: str | None) -> dict[str, Any]:
    with conductor.parts.database.read() as connection:
        if planned_target is not None and planned_target not in store.planned_targets(connection, echo.case_id):
            raise ServiceError(ErrorCode.PLANNED_TARGET_UNKNOWN, f"the case has no planned target {planned_target}")
        return registration_json(connection, echo.registration_id)

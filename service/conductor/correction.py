"""After a verification: a correction from its own image, or the verification is rejected."""

import asyncio
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any

from fastapi import APIRouter, Depends

from service.auth.permissions import Permission
from service.cases import store
from service.cases.records import ArtefactKind
from service.conductor.answers import CommandAnswer
from service.conductor.bodies import Correct, WithReason
from service.conductor.caller import Caller, requesting
from service.conductor.conductor import Conductor, TheConductor, new_id
from service.conductor.image_work import aim, quality_of, registration_json
from service.conductor.route_errors import AIMING, REQUESTING
from service.conductor.taking import Prepared, Standing
from service.conductor.targets import target_artefact
from workflow.case_json import from_json
from workflow.facts import CorrectionRequested, Reasoned, RegistrationQuality
from workflow.triggers import Trigger

router = APIRouter(tags=["verification of a case"])
Chooser = Annotated[Caller, Depends(requesting(Permission.TARGET))]
_UNKNOWN = RegistrationQuality(None, None, None, None, None, None, None, None)


@dataclass(frozen=True, slots=True)
class _Verified:
    """The newest verification's image with its registration, and the target that it judged."""

    image_id: str
    registration_id: str
    registration: Mapping[str, Any]
    target: Mapping[str, Any]


@router.post("/cases/{case_id}/correction-requested", openapi_extra=AIMING)
async def correction_requested(body: Correct, caller: Chooser, conductor: TheConductor) -> CommandAnswer:
    """The verification image becomes image and registration of a corrective move, without a new exposure.

    The target crosses as a raw pixel and is corrected in the new image anew.
    """
    verified = await asyncio.to_thread(_verified, conductor, caller.case_id)
    if verified is None:
        facts = CorrectionRequested("", "", "", _UNKNOWN, body.reason)
        return await asyncio.to_thread(_perform, conductor, caller, Prepared(facts))
    u_px, v_px = verified.target["raw_px"]
    depth_mm = float(verified.target["depth_mm"])
    raw_px = (float(u_px), float(v_px))
    aimed = await aim(conductor, caller.case_id, dict(verified.registration), raw_px, depth_mm)
    quality, ids = quality_of(verified.registration), (verified.image_id, verified.registration_id)
    facts = CorrectionRequested(*ids, new_id(), quality, body.reason, caller.overriding(body.overrides))
    target = target_artefact(facts.target_id, *ids, aimed, depth_mm, verified.target["planned_target"])
    made = {"target": facts.target_id, "registration": verified.registration_id, "image": verified.image_id}
    data = {"reason": body.reason, "overrides": body.overrides}
    prepared = Prepared(facts, (target,), made, data, {"targeting": aimed})
    return await asyncio.to_thread(_perform, conductor, caller, prepared)


@router.post("/cases/{case_id}/verification-rejected", openapi_extra=REQUESTING)
def verification_rejected(body: WithReason, caller: Chooser, conductor: TheConductor) -> CommandAnswer:
    """A person does not believe the verification."""

    def prepare(_: Standing) -> Prepared:
        return Prepared(Reasoned(body.reason), data={"reason": body.reason})

    return conductor.perform(caller, Trigger.VERIFICATION_REJECTED, prepare)


def _perform(conductor: Conductor, caller: Caller, prepared: Prepared) -> CommandAnswer:
    return conductor.perform(caller, Trigger.CORRECTION_REQUESTED, lambda _: prepared)


def _verified(conductor: Conductor, case_id: str) -> _Verified | None:
    with conductor.parts.database.read() as connection:
        case = from_json(dict(store.newest_event(connection, case_id).case_state))
        if case.verification is None or case.target is None:
            return None
        evaluation = store.read_artefact(connection, ArtefactKind.EVALUATION, case.verification.id)
        registration_id = str(evaluation.content["registration_id"])
        return _Verified(
            image_id=case.verification.image_id,
            registration_id=registration_id,
            registration=registration_json(connection, registration_id),
            target=store.read_artefact(connection, ArtefactKind.TARGET, case.target.id).content,
        )

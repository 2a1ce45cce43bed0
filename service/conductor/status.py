"""One atomic status of a case: where it stands, what is allowed, and for everything else every reason why not."""

import math
from collections.abc import Mapping
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Response

from service.auth.dependencies import require
from service.auth.lease import Lease
from service.auth.permissions import Permission, allows
from service.auth.session import Session
from service.auth.users import user_name
from service.cases.preconditions import etag
from service.conductor.answers import AllowanceAnswer, ArmAnswer, LeaseAnswer, ReasonAnswer, StatusAnswer
from service.conductor.command_permissions import CommandPermissions
from service.conductor.conductor import LEASED, Conductor, TheConductor
from service.conductor.route_errors import READING
from service.conductor.snapshots import OF_ANOTHER_IMAGE, as_locked, measured_for
from service.conductor.taking import Rules, Standing, stand
from service.conductor.target_list import target_states
from service.motion.arm_watch import ArmReading
from workflow.case import CaseState
from workflow.decisions import Allowance
from workflow.links import Link
from workflow.machine import allowed
from workflow.snapshot import SafetySnapshot
from workflow.states import GuideState
from workflow.triggers import Trigger
from workflow.verdicts import Verdict

router = APIRouter(tags=["status"])


@router.get("/cases/{case_id}/status", openapi_extra=READING)
def read_status(
    case_id: str,
    response: Response,
    session: Annotated[Session, Depends(require(Permission.READ))],
    conductor: TheConductor,
    permissions: CommandPermissions,
) -> StatusAnswer:
    """The case, the arm and the lease at one moment, under the version that the next request is decided on."""
    with conductor.parts.database.read() as connection:
        standing = stand(connection, conductor.rules, case_id, Trigger.READ)
        targets = target_states(connection, case_id)
        holder = user_name(connection, standing.lease.user_id) if standing.lease is not None else None
    response.headers["ETag"] = etag(standing.last.version)
    offered = allowances(standing.case, standing.snapshot, conductor.rules)
    allowed = {trigger.value: _allowance(trigger, one, session, permissions) for trigger, one in offered.items()}
    return _status(conductor, standing, allowed, _lease(standing.lease, session, holder), targets)


def _status(
    conductor: Conductor,
    standing: Standing,
    allowed: dict[str, AllowanceAnswer],
    lease: LeaseAnswer,
    targets: dict[str, str],
) -> StatusAnswer:
    case = standing.case
    return StatusAnswer(
        case_id=case.case_id,
        state=case.state,
        version=standing.last.version,
        sequence=standing.last.sequence,
        guide=case.guide,
        guide_empty=case.guide is GuideState.EMPTY,
        held_for=case.held_for,
        chain=_chain(case),
        insertion=_insertion(case),
        running_motion=None if case.running is None else {"id": case.running.id, "kind": case.running.kind},
        corrections=case.corrections,
        images=case.images,
        allowed=allowed,
        arm=_arm(conductor.bridge.watch.reading()),
        lease=lease,
        alarms=_alarms(case),
        targets=targets,
    )


def allowances(case: CaseState, snapshot: SafetySnapshot, rules: Rules) -> dict[Trigger, Allowance]:
    """What may be asked now, each request on the displacement since the exposure that it relies on."""
    own = {trigger: measured_for(snapshot, rules.watch, case, trigger) for trigger in OF_ANOTHER_IMAGE}
    own[Trigger.INSERTION_STARTED] = as_locked(snapshot)
    return allowed(case, snapshot, rules.limits, rules.clock(), own)


def _chain(case: CaseState) -> dict[str, str | None]:
    links = {link: case.link(link) for link in Link}
    return {link.value: artefact.id if artefact is not None else None for link, artefact in links.items()}


def _insertion(case: CaseState) -> dict[str, Any] | None:
    one = case.insertion
    if one is None:
        return None
    return {"id": one.id, "status": one.status, "verified": one.verified, "flagged": one.flagged}


def _alarms(case: CaseState) -> list[str]:
    """What a person must look at now."""
    flagged = case.insertion is not None and case.insertion.flagged
    return ["moved_while_the_sleeve_was_in"] if flagged else []


def _allowance(
    trigger: Trigger, allowance: Allowance, session: Session, permissions: Mapping[Trigger, Permission]
) -> AllowanceAnswer:
    reasons = [_reason(verdict) for verdict in allowance.reasons]
    if not allowance.allowed and not reasons:
        code = allowance.code or ""
        reasons = [ReasonAnswer(code=code, message=allowance.message, measured=None, limit=None, unit="")]
    leads_onwards = [trigger.value for trigger in allowance.leads_onwards]
    permitted = trigger not in permissions or allows(session.role, permissions[trigger])
    return AllowanceAnswer(
        allowed=allowance.allowed,
        permitted=permitted,
        needs_control=trigger in LEASED,
        reasons=reasons,
        leads_onwards=leads_onwards,
    )


def _reason(verdict: Verdict) -> ReasonAnswer:
    return ReasonAnswer(
        code=verdict.code,
        message=verdict.message,
        measured=_json_number(verdict.measured),
        limit=_json_number(verdict.limit),
        unit=verdict.unit,
        hard_limit=verdict.hard_limit,
        overridable=verdict.overridable,
    )


def _json_number(value: float | str | bool | None) -> float | str | bool | None:
    """JSON has no NaN and no infinity; they are told as text."""
    return str(value) if isinstance(value, float) and not math.isfinite(value) else value


def _lease(lease: Lease | None, session: Session, holder: str | None) -> LeaseAnswer:
    if lease is None:
        return LeaseAnswer(held=False, user_id=None, user=None, control_token=None, taken_at=None, yours=False)
    yours = lease.session_id == session.id
    token = lease.fencing_token if yours else None
    return LeaseAnswer(
        held=True,
        user_id=lease.user_id,
        user=holder,
        control_token=token,
        taken_at=lease.taken_at,
        yours=yours,
    )


def _arm(reading: ArmReading | None) -> ArmAnswer:
    arm, status = (None, None) if reading is None else (reading.arm, reading.status)
    return ArmAnswer(
        age_s=reading.arm_age_s if reading is not None and arm is not None else None,
        connected=status is not None and status.connected,
        phase=status.phase if status is not None else None,
        safety=arm.safety if arm is not None else None,
        at_rest=reading.at_rest if reading is not None else None,
        program_running=arm.program_running if arm is not None else None,
        joints_deg=[math.degrees(joint) for joint in arm.joints_rad] if arm is not None else None,
        base_from_tcp=arm.base_from_tcp.tolist() if arm is not None else None,
        tcp_speed_mm_s=arm.tcp_speed_mm_s if arm is not None else None,
    )

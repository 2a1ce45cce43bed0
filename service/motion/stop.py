"""Stop and emergency access: sent first, recorded after.

Nothing comes before them: no database, lease, version or image work.
"""

import asyncio
from typing import Annotated, Any

import structlog
from fastapi import APIRouter, Depends

from service.audit import record_audit
from service.auth.dependencies import stop_caller
from service.auth.session import Session
from service.conductor.answers import EmergencyAccessAnswer, StopAnswer
from service.conductor.conductor import Conductor, TheConductor
from service.conductor.taking import Prepared, Taken
from service.errors import ErrorCode, ServiceError
from workflow.facts import Stopped
from workflow.triggers import Trigger

router = APIRouter(tags=["stop"])
Presser = Annotated[Session, Depends(stop_caller)]
_log = structlog.get_logger(__name__)
_AGAIN_S = 0.5
# What the answer says of the record; the recording itself goes on until it is done.
_RECORDED_WITHIN_S = 2.0
_RELEASED_WITHIN_S = 2.0  # an arm at full speed is at rest within half a second
_UNRECORDABLE = frozenset({ErrorCode.CASE_UNKNOWN, ErrorCode.CASE_ELSEWHERE})  # here, however often it is tried
_recordings: set["asyncio.Task[Taken | None]"] = set()


@router.post("/stop")
async def stop(session: Presser, conductor: TheConductor) -> StopAnswer:
    """Stop the arm: everyone who has signed in, in every state, with a locked or expired session too."""
    return await _stop(conductor, session, None)


@router.post("/cases/{case_id}/stop")
async def stop_in_case(case_id: str, session: Presser, conductor: TheConductor) -> StopAnswer:
    """Stop the arm, and record it in the room's open case; in this one only where the room has none."""
    return await _stop(conductor, session, case_id)


@router.post("/cases/{case_id}/emergency-access")
async def emergency_access(case_id: str, session: Presser, conductor: TheConductor) -> EmergencyAccessAnswer:
    """Stop the arm, leave it to whoever stands at the pendant, and hold the case; open to the same as stop."""
    conductor.bridge.stop_to_record()
    sent = conductor.bridge.release_pendant(f"emergency access for {session.user_id}")
    recording = asyncio.create_task(_recorded(conductor, session, case_id, emergency_access=True))
    released = await asyncio.to_thread(conductor.bridge.wait_for_pendant, _RELEASED_WITHIN_S)
    recorded = await recording
    return EmergencyAccessAnswer(sent_to_guard=sent, pendant_released=released, **recorded)


async def _stop(conductor: Conductor, session: Session, case_id: str | None) -> StopAnswer:
    # Up to here all ran on the event loop: a thread would have had to be waited for.
    conductor.bridge.stop_to_record()
    sent = conductor.bridge.stop(f"pressed by {session.user_id}")
    return StopAnswer(sent_to_guard=sent, **await _recorded(conductor, session, case_id))


async def _recorded(conductor: Conductor, session: Session, case_id: str | None, **data: bool) -> dict[str, Any]:
    """What the answer says of the record of a stop that was sent."""
    recording = asyncio.create_task(_record(conductor, session, case_id, data))
    _recordings.add(recording)
    recording.add_done_callback(_recordings.discard)
    done, _ = await asyncio.wait({recording}, timeout=_RECORDED_WITHIN_S)
    taken = recording.result() if done else None
    return {
        "recorded": bool(done),
        "case_id": taken.event.case_id if taken else None,
        "version": taken.event.version if taken else None,
    }


async def _record(conductor: Conductor, session: Session, case_id: str | None, data: dict[str, bool]) -> Taken | None:
    """Record the stop, again and again until it is in; what keeps it out is told when it changes."""
    told = None
    try:
        while True:
            try:
                return await asyncio.to_thread(_write, conductor, session, case_id, data)
            except ServiceError as error:
                if error.code != told:
                    _log.error("stop_not_recorded", code=error.code)
                told, case_id = error.code, None if error.code in _UNRECORDABLE else case_id
            await asyncio.sleep(_AGAIN_S)
    finally:
        conductor.bridge.stop_recorded()


def _write(conductor: Conductor, session: Session, case_id: str | None, data: dict[str, bool]) -> Taken | None:
    case_id = conductor.open_case() or case_id  # whatever case was named, this one's arm is stopped and locked
    if case_id is None:
        with conductor.parts.database.write() as connection:
            record_audit(connection, Trigger.STOP, session.user_id, data)
        return None
    prepared = Prepared(Stopped(session.user_id), data=data)
    return conductor.observe(case_id, Trigger.STOP, lambda _: prepared, session.user_id)

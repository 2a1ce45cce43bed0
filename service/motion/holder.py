"""Whether whoever holds the button may still move the arm: asked all the while, for the guard knows of no sessions."""

import asyncio
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import structlog

from service.auth.dependencies import active
from service.auth.permissions import Permission, allows
from service.auth.session import Session
from service.auth.sessions import SessionStore
from service.conductor.caller import Caller
from service.conductor.conductor import Conductor
from service.conductor.taking import Prepared
from service.errors import ErrorCode, ServiceError
from service.motion.endings import Ending
from service.problem_json import problem_of
from workflow.facts import Faulted, FaultKind
from workflow.triggers import Trigger

_log = structlog.get_logger(__name__)
# With the database's answer and the way of the stop well below the 200 ms of silence that the guard allows.
_ASK_EVERY_S = 0.05
# A database that has not said for so long whether the session stands counts as having said no.
_UNKNOWN_FOR_S = 1.0
# The guard waits for the arm's rest for up to three.
_ENDED_WITHIN_S = 4.0
# A thread of its own: the shared ones may all be waiting to write, and a motion must not end for an image's record.
_asking = ThreadPoolExecutor(1, thread_name_prefix="holder")


async def session_over(sessions: SessionStore, token: str) -> ServiceError:
    """Why the session of a token is no longer good for a motion, once it is not (H27).

    Asking counts as no use: the start of the motion did, and none lasts as long as the pause that locks a session.
    """
    known_at_s = time.monotonic()
    while True:
        try:
            async with asyncio.timeout(known_at_s + _UNKNOWN_FOR_S - time.monotonic()):
                session = await _look(sessions, token)
        except (TimeoutError, ServiceError):
            unknown_s = time.monotonic() - known_at_s
            if unknown_s >= _UNKNOWN_FOR_S:
                return _unknown(unknown_s)
        else:
            known_at_s = time.monotonic()
            try:
                check_holder(session)
            except ServiceError as refusal:
                return refusal
        await asyncio.sleep(_ASK_EVERY_S)


async def lose_hold(
    conductor: Conductor, caller: Caller, refusal: ServiceError, ending: "asyncio.Future[Ending]"
) -> Ending | None:
    """Stop the arm for a holder who may hold no longer, record why, and wait for the end of the motion.

    The stop is sent first, like every stop. One that cannot be recorded here the observer of the motion's end records.
    """
    conductor.bridge.stop_to_record()
    conductor.bridge.stop(f"the session that holds is over: {refusal.code}")
    _log.warning("hold_ended", case_id=caller.case_id, session=caller.session.id, reason=refusal.code)
    try:
        await asyncio.to_thread(_record, conductor, caller, refusal)
    except ServiceError as error:
        _log.error("lost_hold_not_recorded", case_id=caller.case_id, code=error.code)
    finally:
        conductor.bridge.stop_recorded()
    await asyncio.wait({ending}, timeout=_ENDED_WITHIN_S)
    if not ending.done():
        return None
    return replace(ending.result(), cause=FaultKind.SESSION_OVER, problem=problem_of(refusal).model_dump(mode="json"))


def _record(conductor: Conductor, caller: Caller, refusal: ServiceError) -> None:
    data = {"code": refusal.code, "session": caller.session.id, "measured": refusal.measured, "limit": refusal.limit}
    prepared = Prepared(Faulted(FaultKind.SESSION_OVER), data=data)
    conductor.observe(caller.case_id, Trigger.FAULT, lambda _: prepared)


async def _look(sessions: SessionStore, token: str) -> Session | None:
    return await asyncio.get_running_loop().run_in_executor(_asking, sessions.look, token)


def check_holder(session: Session | None) -> None:
    """ServiceError where whoever has this session may not hold the button."""
    if session is None:
        raise ServiceError(ErrorCode.NOT_SIGNED_IN, "the session of whoever holds was ended")
    if not allows(active(session).role, Permission.MOVE):
        raise ServiceError(ErrorCode.PERMISSION_MISSING, f"the role {session.role} may not {Permission.MOVE}")


def _unknown(unknown_s: float) -> ServiceError:
    message = "the database does not say whether the session stands (s)"
    return ServiceError(ErrorCode.DATABASE_BUSY, message, measured=unknown_s, limit=_UNKNOWN_FOR_S)

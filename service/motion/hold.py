"""The held button: heartbeats from the tablet to the guard, challenges and progress back; it invents nothing."""

import asyncio
import math
import time
from dataclasses import dataclass, fields
from functools import partial
from typing import Annotated, Any, Self

import structlog
from fastapi import APIRouter, Depends, Query, WebSocket, WebSocketDisconnect
from pydantic import BaseModel, ConfigDict, Field, ValidationError
from starlette.status import WS_1008_POLICY_VIOLATION

from robot.frames import Transform, distance_between
from robot.guard.messages import Heartbeat, Status
from service.auth.dependencies import any_session, bearer_or_cookie, current_session, require
from service.auth.lease import lease_of
from service.auth.permissions import Permission
from service.auth.session import Session
from service.conductor.caller import Caller
from service.conductor.conductor import Conductor, TheConductor
from service.conductor.starting import goal_of_permit, start_move
from service.conductor.taking import case_here
from service.errors import ServiceError
from service.motion.endings import Ending, Endings
from service.motion.holder import check_holder, lose_hold, session_over
from service.motion.status_bell import StatusBell
from service.problem_json import problem_of

router = APIRouter(tags=["motions of a case"])
_log = structlog.get_logger(__name__)
_LOOK_EVERY_S = 0.01
_HELD_WITHIN_S = 10.0  # without a held heartbeat the socket is closed: nothing was started
_LARGEST_MESSAGE = 512
_ENDING = tuple(field.name for field in fields(Ending))


class HeartbeatMessage(BaseModel):
    """What the tablet sends for each challenge."""

    model_config = ConfigDict(extra="forbid")
    number: int = Field(ge=0, le=2**53)
    challenge: str = Field(max_length=64)
    held: bool

    @classmethod
    def of(cls, text: str) -> Self:
        """What a frame says; ValidationError where that is no heartbeat."""
        return cls.model_validate_json(text[:_LARGEST_MESSAGE])


@dataclass(frozen=True, slots=True, eq=False)
class _Hold:
    """One held button."""

    socket: WebSocket
    conductor: Conductor
    caller: Caller
    permit_id: str
    base_from_goal: Transform


@router.websocket("/cases/{case_id}/hold")
async def hold(
    socket: WebSocket,
    case_id: str,
    session: Annotated[Session, Depends(require(Permission.MOVE))],
    conductor: TheConductor,
    permit: Annotated[str, Query(max_length=64)],
    control_token: Annotated[int | None, Query(ge=0)] = None,
) -> None:
    """Hold the button for a permit: the motion starts with the first live heartbeat and ends with the release."""
    caller = Caller(session, case_id, None, None, control_token)
    goal = await asyncio.to_thread(_goal, conductor, caller, permit)
    await socket.accept()
    endings: Endings = socket.app.state.endings
    with endings.expected(permit) as ending:
        await _run(_Hold(socket, conductor, caller, permit, goal), ending)


async def _run(held: _Hold, ending: "asyncio.Future[Ending]") -> None:
    """Until the motion is over, or the tablet is gone, which the guard notices by itself."""
    forwarding, reporting = asyncio.create_task(_forward(held)), asyncio.create_task(_report(held))
    starting = asyncio.create_task(_start(held))
    try:
        await _first_of(forwarding, starting)
        over = starting.result() if starting.done() else None
        if starting.done() and over is None:
            over = await _moved(held, forwarding, ending)
        reporting.cancel()
        if over is not None and (forwarding.cancelled() or not forwarding.done()):
            await held.socket.send_json({"type": "ended"} | {name: getattr(over, name) for name in _ENDING})
            await held.socket.close()
    except WebSocketDisconnect:
        _log.warning("hold_ended", case_id=held.caller.case_id, reason="disconnected")
    finally:
        for task in (forwarding, reporting, starting):
            task.cancel()
        await asyncio.gather(forwarding, reporting, starting, return_exceptions=True)


async def _moved(held: _Hold, forwarding: "asyncio.Task[None]", ending: "asyncio.Future[Ending]") -> Ending | None:
    """The motion's end; one whose holder may hold no longer is ended as if the hold were lost."""
    token = bearer_or_cookie(held.socket) or ""
    watching = asyncio.create_task(session_over(held.conductor.parts.sessions, token))
    try:
        await _first_of(forwarding, ending, watching)
        if ending.done() or not watching.done():
            return ending.result() if ending.done() else None
        forwarding.cancel()  # whatever becomes of the stop, the guard hears no hand from now on
        return await lose_hold(held.conductor, held.caller, watching.result(), ending)
    finally:
        watching.cancel()


async def _first_of(*awaited: "asyncio.Future[Any]") -> None:
    await asyncio.wait(awaited, return_when=asyncio.FIRST_COMPLETED)


async def _forward(held: _Hold) -> None:
    """Pass heartbeats on as they come; what is no heartbeat ends the hold, which is silence to the guard.

    Nothing is passed on under a permit that is good for nothing any more: the guard hears one hand at a time, and an
    old one's first word would take the place of the hand that holds now, and end its motion. To a motion that goes on
    under such a permit, this is silence, too.
    """
    try:
        while True:
            text = await held.socket.receive_text()
            beat = HeartbeatMessage.of(text)
            if _is_current(held):
                held.conductor.bridge.heartbeat(Heartbeat(held.permit_id, beat.number, beat.challenge, beat.held))
    except (WebSocketDisconnect, ValidationError, KeyError) as error:  # KeyError: a binary message
        _log.info("hold_ended", case_id=held.caller.case_id, reason=type(error).__name__)
        if not isinstance(error, WebSocketDisconnect):
            await held.socket.close(WS_1008_POLICY_VIOLATION, "no heartbeat")


async def _report(held: _Hold) -> None:
    """Send each status down: the challenge to echo, and how far it is to the goal."""
    bell: StatusBell = held.socket.app.state.bell
    while True:
        await bell.wait()
        status = held.conductor.bridge.status
        if status is not None:
            await held.socket.send_json(_progress(status, held.base_from_goal))


async def _start(held: _Hold) -> Ending | None:
    """Start the motion once the guard hears the button held; an ending if it does not come to that."""
    end_s = time.monotonic() + _HELD_WITHIN_S
    while not _is_live(held):
        if _is_released(held) or not _is_current(held) or time.monotonic() > end_s:
            live = held.conductor.live
            return Ending("not_started", live.state if live else "", 0, None, None, None)
        await asyncio.sleep(_LOOK_EVERY_S)
    try:
        await _sign_in_again(held)
        check = partial(_check_holder, held)
        await asyncio.to_thread(start_move, held.conductor, held.caller, held.permit_id, check)
    except ServiceError as error:
        live = held.conductor.live
        problem = problem_of(error).model_dump(mode="json")
        return Ending("refused", live.state if live else "", 0, None, None, problem)
    return None


async def _sign_in_again(held: _Hold) -> None:
    """ServiceError where the session was locked or ended since the socket was opened (H27)."""
    await current_session(await asyncio.to_thread(any_session, held.socket, held.conductor.parts, None))


def _check_holder(held: _Hold) -> None:
    check_holder(held.conductor.parts.sessions.look(bearer_or_cookie(held.socket) or ""))


def _is_live(held: _Hold) -> bool:
    status = held.conductor.bridge.status
    if status is None or status.permit_id != held.permit_id or status.heartbeat_age_s is None:
        return False
    age_s = status.heartbeat_age_s + time.monotonic() - status.sent_at_s
    return status.held and age_s <= held.conductor.rules.limits.heartbeat_age_s


def _is_current(held: _Hold) -> bool:
    """Whether the permit is the case's newest, or that of the motion under way."""
    live = held.conductor.live
    if live is None or live.case_id != held.caller.case_id:
        return False
    permit_id = live.used_permit_id if live.running is not None else live.permit and live.permit.id
    return permit_id == held.permit_id


def _is_released(held: _Hold) -> bool:
    status = held.conductor.bridge.status
    return status is not None and status.permit_id == held.permit_id and not status.held


def _progress(status: Status, base_from_goal: Transform) -> dict[str, Any]:
    message: dict[str, Any] = {
        "type": "progress",
        "challenge": status.challenge,
        "phase": status.phase,
        "held": status.held,
        "distance_mm": None,
        "angle_deg": None,
    }
    if status.arm is not None:
        distance_mm, angle_rad = distance_between(status.arm.base_from_tcp, base_from_goal)
        message |= {"distance_mm": distance_mm, "angle_deg": math.degrees(angle_rad)}
    return message


def _goal(conductor: Conductor, caller: Caller, permit_id: str) -> Transform:
    """Where the motion goes; a permit that is not the case's own is refused by the rules, with every verdict.

    So is a hand without control, or on a case of another room: its heartbeats would reach the guard before the start of
    the motion is refused, and take the place of those that it hears (H15, H19).
    """
    with conductor.parts.database.read() as connection:
        case_here(connection, conductor.rules, caller.case_id)
    permit = conductor.case_of(caller.case_id).permit
    if permit is None or permit.id != permit_id or not _has_control(conductor, caller):
        start_move(conductor, caller, permit_id)
        raise AssertionError(f"permit {permit_id} is not the case's or the hand without control, and was taken")
    return goal_of_permit(conductor, caller.case_id, permit_id)


def _has_control(conductor: Conductor, caller: Caller) -> bool:
    with conductor.parts.database.read() as connection:
        lease = lease_of(connection, caller.case_id)
    newest = None if lease is None else (lease.session_id, lease.fencing_token)
    return newest == (caller.session.id, caller.control_token)

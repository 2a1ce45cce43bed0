"""What a route writes to say who may call it.

    @router.post("/cases/{case_id}/target-confirmed")
    def target_confirmed(session: Annotated[Session, Depends(require(Permission.TARGET))]) -> ...: ...

Stop alone uses `stop_caller`, which asks no database.

What asks none is async: anything else would wait for a free thread, and for its turn with the interpreter, once more.
"""

import asyncio
from collections.abc import Awaitable, Callable
from typing import Annotated

import structlog
from fastapi import Depends
from starlette.requests import HTTPConnection

from service.audit import record_audit
from service.auth.origin import check_origin
from service.auth.permissions import Permission, allows
from service.auth.session import Session, SessionStatus
from service.errors import ErrorCode, ServiceError
from service.parts import Parts, parts_of

COOKIE = "coaxial_session"
_log = structlog.get_logger(__name__)


def bearer_or_cookie(connection: HTTPConnection) -> str | None:
    """The caller's opaque token: the Authorization header if it bears one, else the cookie."""
    scheme, _, token = connection.headers.get("authorization", "").partition(" ")
    if scheme.lower() == "bearer" and token:
        return token
    return connection.cookies.get(COOKIE)


async def refuse_foreign_origin(connection: HTTPConnection, parts: Annotated[Parts, Depends(parts_of)]) -> None:
    """ServiceError ORIGIN_REFUSED for what another site's page sends."""
    check_origin(connection, parts.settings.http.origins)


_SameSite = Depends(refuse_foreign_origin)


def any_session(
    connection: HTTPConnection, parts: Annotated[Parts, Depends(parts_of)], _: Annotated[None, _SameSite]
) -> Session:
    """The caller's session, locked or expired as it may be; ServiceError NOT_SIGNED_IN or ORIGIN_REFUSED."""
    token = bearer_or_cookie(connection)
    session = parts.sessions.find(token) if token else None
    if session is None:
        raise ServiceError(ErrorCode.NOT_SIGNED_IN, "no session belongs to this request")
    return session


async def current_session(session: Annotated[Session, Depends(any_session)]) -> Session:
    """The caller's session, active; ServiceError SESSION_LOCKED or SESSION_EXPIRED otherwise."""
    return active(session)


def active(session: Session) -> Session:
    """The session; ServiceError SESSION_LOCKED or SESSION_EXPIRED where it is that."""
    if session.status is SessionStatus.LOCKED:
        raise ServiceError(ErrorCode.SESSION_LOCKED, "the session is locked after a pause")
    if session.status is SessionStatus.EXPIRED:
        raise ServiceError(ErrorCode.SESSION_EXPIRED, "the session is over")
    return session


async def stop_caller(
    connection: HTTPConnection, parts: Annotated[Parts, Depends(parts_of)], _: Annotated[None, _SameSite]
) -> Session:
    """Everyone who has signed in, from memory alone: no database stands between a person and the stop."""
    token = bearer_or_cookie(connection)
    session = parts.sessions.remembered(token) if token else None
    if session is None:
        raise ServiceError(ErrorCode.NOT_SIGNED_IN, "no session belongs to this request")
    return session


def require(permission: Permission) -> Callable[..., Awaitable[Session]]:
    """A dependency that lets only roles with `permission` through; ServiceError PERMISSION_MISSING, recorded."""

    async def permitted(
        connection: HTTPConnection,
        session: Annotated[Session, Depends(current_session)],
        parts: Annotated[Parts, Depends(parts_of)],
    ) -> Session:
        if not allows(session.role, permission):
            await asyncio.to_thread(_record_refusal, connection, parts, session, permission)
            raise ServiceError(ErrorCode.PERMISSION_MISSING, f"the role {session.role} may not {permission}")
        return session

    permitted.__dict__["permission"] = permission  # the test that walks the routes reads it
    return permitted


def _record_refusal(connection: HTTPConnection, parts: Parts, session: Session, permission: Permission) -> None:
    """Who tried what their role may not; the route's pattern, for an address could hold what a person typed."""
    route = getattr(connection.scope.get("route"), "path", "none")
    case_id = connection.path_params.get("case_id")
    data = {"permission": permission, "role": session.role, "route": route, "case_id": case_id}
    try:
        with parts.database.write() as writer:
            record_audit(writer, "permission_refused", session.user_id, data)
    except ServiceError as fault:  # refused all the same
        _log.error("refusal_not_recorded", code=fault.code)

"""What a route writes to say who may call it.

    @router.post("/cases/{case_id}/target-confirmed")
    def target_confirmed(session: Annotated[Session, Depends(require(Permission.TARGET))]) -> ...: ...

Stop alone uses `stop_caller`, which asks no database.
"""

from collections.abc import Callable
from typing import Annotated

from fastapi import Depends
from starlette.requests import HTTPConnection

from service.auth.origin import check_origin
from service.auth.permissions import Permission, allows
from service.auth.session import Session, SessionStatus
from service.errors import ErrorCode, ServiceError
from service.parts import Parts, parts_of

COOKIE = "coaxial_session"


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


def current_session(session: Annotated[Session, Depends(any_session)]) -> Session:
    """The caller's session, active; ServiceError SESSION_LOCKED or SESSION_EXPIRED otherwise."""
    if session.status is SessionStatus.LOCKED:
        raise ServiceError(ErrorCode.SESSION_LOCKED, "the session is locked after a pause")
    if session.status is SessionStatus.EXPIRED:
        raise ServiceError(ErrorCode.SESSION_EXPIRED, "the session is over")
    return session


async def stop_caller(
    connection: HTTPConnection, parts: Annotated[Parts, Depends(parts_of)], _: Annotated[None, _SameSite]
) -> Session:
    """Everyone who has signed in, from memory alone: no database stands between a person and the stop.

    Async, as what it depends on: others would wait for a free thread, and threads wait for the database.
    """
    token = bearer_or_cookie(connection)
    session = parts.sessions.remembered(token) if token else None
    if session is None:
        raise ServiceError(ErrorCode.NOT_SIGNED_IN, "no session belongs to this request")
    return session


def require(permission: Permission) -> Callable[..., Session]:
    """A dependency that lets only roles with `permission` through; ServiceError PERMISSION_MISSING."""

    def permitted(session: Annotated[Session, Depends(current_session)]) -> Session:
        if not allows(session.role, permission):
            raise ServiceError(ErrorCode.PERMISSION_MISSING, f"the role {session.role} may not {permission}")
        return session

    permitted.__dict__["permission"] = permission  # the test that walks the routes reads it
    return permitted

"""Sign in, lock, unlock, sign out."""

from typing import Annotated, Any

from fastapi import APIRouter, Depends, Response
from pydantic import BaseModel, ConfigDict, Field, model_validator
from starlette.requests import HTTPConnection

from service.audit import record_audit
from service.auth.dependencies import COOKIE, any_session, bearer_or_cookie, refuse_foreign_origin
from service.auth.permissions import ROLE_PERMISSIONS
from service.auth.session import Session, SessionStatus
from service.errors import ErrorCode, ServiceError
from service.openapi import NO_SESSION, may_fail_with
from service.parts import Parts, parts_of

router = APIRouter(tags=["session"])


class SignIn(BaseModel):
    """A name with the password, or at a tablet with the PIN."""

    model_config = ConfigDict(extra="forbid")
    name: str = Field(max_length=64)
    password: str | None = Field(default=None, max_length=256)
    pin: str | None = Field(default=None, max_length=12)

    @model_validator(mode="after")
    def _one_proof(self) -> "SignIn":
        if (self.password is None) == (self.pin is None):
            raise ValueError("either password or pin")
        return self


class Unlock(BaseModel):
    """The PIN of the session's own user."""

    model_config = ConfigDict(extra="forbid")
    pin: str = Field(max_length=12)


class SessionView(BaseModel):
    """Who is signed in, and what the role may do."""

    user: str
    user_id: str
    role: str
    status: SessionStatus
    permissions: list[str]
    expires_at_s: float
    idle_lock_s: float


class SignedIn(SessionView):
    """A session just made; the token is told this once."""

    token: str


def _view(session: Session, parts: Parts) -> dict[str, Any]:
    return {
        "user": session.user_name,
        "user_id": session.user_id,
        "role": session.role,
        "status": session.status,
        "permissions": sorted(ROLE_PERMISSIONS[session.role]),
        "expires_at_s": session.expires_at_s,
        "idle_lock_s": parts.settings.session.idle_lock_s,
    }


@router.post(
    "/session",
    status_code=201,
    dependencies=[Depends(refuse_foreign_origin)],
    openapi_extra=may_fail_with(ErrorCode.SIGN_IN_REFUSED, ErrorCode.SIGN_IN_BUSY, ErrorCode.LOCKED_OUT) | NO_SESSION,
)
def sign_in(body: SignIn, response: Response, parts: Annotated[Parts, Depends(parts_of)]) -> SignedIn:
    """Sign in: a bearer token, and the same as a cookie."""
    if body.pin is None:
        user = parts.proofs.sign_in(body.name, body.password or "")
    else:
        user = parts.proofs.sign_in_with_pin(body.name, body.pin)
    token, session = parts.sessions.create(user)
    with parts.database.write() as connection:
        record_audit(connection, "signed_in", user.id, {"session": session.id})
    secure = parts.settings.http.secure_cookie
    response.set_cookie(COOKIE, token, httponly=True, samesite="strict", secure=secure, path="/api")
    return SignedIn(**_view(session, parts), token=token)


@router.get("/session")
def read_session(
    session: Annotated[Session, Depends(any_session)], parts: Annotated[Parts, Depends(parts_of)]
) -> SessionView:
    """The caller's session, locked or expired as it may be."""
    return SessionView(**_view(session, parts))


@router.post("/session/lock")
def lock(session: Annotated[Session, Depends(any_session)], parts: Annotated[Parts, Depends(parts_of)]) -> SessionView:
    """Lock until the PIN is entered; stop still works."""
    parts.sessions.lock(session)
    return SessionView(**_view(session, parts) | {"status": SessionStatus.LOCKED})


@router.post("/session/unlock", openapi_extra=may_fail_with(ErrorCode.PIN_REFUSED, ErrorCode.LOCKED_OUT))
def unlock(
    body: Unlock, session: Annotated[Session, Depends(any_session)], parts: Annotated[Parts, Depends(parts_of)]
) -> SessionView:
    """Make a locked session active again with the PIN."""
    if session.status is SessionStatus.EXPIRED:
        raise ServiceError(ErrorCode.SESSION_EXPIRED, "the session is over")
    parts.proofs.confirm_pin(session, body.pin)
    return SessionView(**_view(parts.sessions.unlock(session), parts))


@router.delete("/session", status_code=204)
def sign_out(
    connection: HTTPConnection,
    response: Response,
    session: Annotated[Session, Depends(any_session)],
    parts: Annotated[Parts, Depends(parts_of)],
) -> None:
    """Sign out: the token is good for nothing from now on."""
    token = bearer_or_cookie(connection)
    assert token is not None  # noqa: S101  `any_session` found the session by it
    parts.sessions.revoke(token)
    with parts.database.write() as database:
        record_audit(database, "signed_out", session.user_id, {"session": session.id})
    response.delete_cookie(COOKIE, path="/api")

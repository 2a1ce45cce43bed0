"""Who sends a command, on which version, under which key: the same for every command of a case.

Requests need If-Match and Idempotency-Key; facts are never refused, so they need neither.
"""

from collections.abc import Awaitable, Callable, Mapping
from dataclasses import dataclass
from typing import Annotated

from fastapi import Depends, Header, Request

from service.auth.dependencies import require
from service.auth.permissions import Permission, Role
from service.auth.session import Session
from service.cases.idempotency import Intent
from service.cases.preconditions import expected_version, intent, meant_by
from service.parts import Parts, parts_of
from workflow.overrides import Override


@dataclass(frozen=True, slots=True)
class Caller:
    """A signed-in person and what came in the headers of their command."""

    session: Session
    case_id: str
    version: int | None
    intent: Intent | None
    control_token: int | None

    def overriding(self, reasons: Mapping[str, str]) -> tuple[Override, ...]:
        """Overrides as this person says them: interlocks by code, each with the reason."""
        surgeon = self.session.role is Role.SURGEON
        return tuple(Override(code, reason, surgeon) for code, reason in reasons.items())


ControlToken = Annotated[int | None, Header(ge=0, le=2**31)]


def requesting(permission: Permission) -> Callable[..., Awaitable[Caller]]:
    """A dependency for requests; ServiceError VERSION_MISSING, IDEMPOTENCY_KEY_MISSING or PERMISSION_MISSING."""

    async def caller(
        case_id: str,
        session: Annotated[Session, Depends(require(permission))],
        version: Annotated[int, Depends(expected_version)],
        meant: Annotated[Intent, Depends(intent)],
        control_token: ControlToken = None,
    ) -> Caller:
        return Caller(session, case_id, version, meant, control_token)

    return caller


def stating(permission: Permission) -> Callable[..., Awaitable[Caller]]:
    """A dependency for facts; a key is honoured if there is one; ServiceError PERMISSION_MISSING."""

    async def caller(
        request: Request,
        case_id: str,
        session: Annotated[Session, Depends(require(permission))],
        parts: Annotated[Parts, Depends(parts_of)],
        idempotency_key: Annotated[str | None, Header(max_length=128)] = None,
    ) -> Caller:
        meant = await meant_by(request, session, parts, idempotency_key) if idempotency_key else None
        return Caller(session, case_id, None, meant, None)

    return caller

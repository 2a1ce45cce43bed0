"""Who is asking."""

from dataclasses import dataclass
from enum import StrEnum

from service.auth.permissions import Role


class SessionStatus(StrEnum):
    """What a sign-in is still good for; stop works with all of them."""

    ACTIVE = "active"
    LOCKED = "locked"
    EXPIRED = "expired"


@dataclass(frozen=True, slots=True)
class Session:
    """A signed-in user."""

    id: str
    user_id: str
    user_name: str
    role: Role
    status: SessionStatus
    expires_at_s: float

"""The control lease of a case: one holder, a fencing token that only grows (H15)."""

from dataclasses import dataclass

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.auth.session import Session
from service.database import tables
from service.database.clock import now_utc
from service.errors import ErrorCode, ServiceError

_LEASE = sa.select(tables.leases).where(tables.leases.c.case_id == sa.bindparam("case_id"))


@dataclass(frozen=True, slots=True)
class Lease:
    """Who holds control of a case."""

    case_id: str
    fencing_token: int
    session_id: str
    user_id: str
    reason: str
    taken_at: str


def lease_of(connection: Connection, case_id: str) -> Lease | None:
    """The lease of a case, if somebody has ever taken it."""
    row = connection.execute(_LEASE, {"case_id": case_id}).first()
    return None if row is None else Lease(**row._mapping)


def take_lease(connection: Connection, case_id: str, session: Session, reason: str) -> Lease:
    """Take control, from whoever has it; the token is one above every earlier one of the case."""
    before = lease_of(connection, case_id)
    lease = Lease(case_id, (before.fencing_token if before else 0) + 1, session.id, session.user_id, reason, now_utc())
    values = {name: getattr(lease, name) for name in Lease.__slots__}
    if before is None:
        connection.execute(sa.insert(tables.leases).values(values))
    else:
        connection.execute(sa.update(tables.leases).where(tables.leases.c.case_id == case_id).values(values))
    return lease


def check_lease(lease: Lease | None, session: Session, fencing_token: int | None) -> Lease:
    """The case's lease, if this session holds it with its newest token; ServiceError LEASE_MISSING or LEASE_LOST."""
    if lease is None or fencing_token is None:
        raise ServiceError(ErrorCode.LEASE_MISSING, "this request needs the control lease")
    if lease.fencing_token != fencing_token:
        raise ServiceError(
            ErrorCode.LEASE_LOST, "control was taken since", measured=fencing_token, limit=lease.fencing_token
        )
    if lease.session_id != session.id:
        raise ServiceError(ErrorCode.LEASE_LOST, "control is held elsewhere")
    return lease

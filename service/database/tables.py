"""The tables. Records are only ever added to; triggers in the database refuse UPDATE and DELETE on them.

Times are UTC text of one fixed form, so that they sort and hash alike on every database; order comes from sequence
numbers, never from times (H23).
"""

import sqlalchemy as sa
from sqlalchemy import JSON, BigInteger, Boolean, Column, Float, ForeignKey, Integer, LargeBinary, String, Table, Text

metadata = sa.MetaData(
    naming_convention={
        "pk": "pk_%(table_name)s",
        "uq": "uq_%(table_name)s_%(column_0_N_name)s",
        "fk": "fk_%(table_name)s_%(column_0_N_name)s",
        "ix": "ix_%(table_name)s_%(column_0_N_name)s",
    }
)

LARGEST_SEQUENCE = 2**31 - 1
"""Of PostgreSQL's integers: a greater sequence number is none that a query can ask for."""

# SQLite numbers rows by itself only in an INTEGER primary key.
_RowNumber = BigInteger().with_variant(Integer, "sqlite")
_OptionalJson = JSON(none_as_null=True)
_IS_OVER = sa.text("state IN ('closed', 'aborted')")


def _id() -> Column[str]:
    return Column("id", String, primary_key=True)


def _row_number() -> Column[int]:
    return Column("id", _RowNumber, primary_key=True, autoincrement=True)


def _at(name: str = "recorded_at", *, nullable: bool = False) -> Column[str]:
    return Column(name, String(32), nullable=nullable)


def _case(*, nullable: bool = False) -> Column[str]:
    return Column("case_id", ForeignKey("cases.id"), nullable=nullable, index=True)


def _artefact(name: str, *extra: sa.schema.SchemaItem) -> Table:
    """A table of artefacts: each names the event that made it and the artefacts it was made from."""
    return Table(
        name,
        metadata,
        _id(),
        Column("case_id", String, nullable=False),
        Column("sequence", Integer, nullable=False),
        Column("made_from", JSON, nullable=False),
        Column("content", JSON, nullable=False),
        _at(),
        *extra,
        sa.ForeignKeyConstraint(["case_id", "sequence"], ["events.case_id", "events.sequence"]),
        sa.Index(f"ix_{name}_case_id_sequence", "case_id", "sequence"),
    )


# --- mutable ---------------------------------------------------------------------------------------------------------
users = Table(
    "users",
    metadata,
    _id(),
    Column("name", String(64), nullable=False, unique=True),
    Column("role", String(16), nullable=False),
    Column("password_hash", String, nullable=False),
    Column("pin_hash", String, nullable=False),
    _at("created_at"),
    _at("disabled_at", nullable=True),
)
sessions = Table(
    "sessions",
    metadata,
    _id(),
    Column("token_sha256", String(64), nullable=False, unique=True),
    Column("user_id", ForeignKey("users.id"), nullable=False),
    _at("created_at"),
    Column("expires_at_s", Float, nullable=False),
    Column("last_seen_at_s", Float, nullable=False),
    _at("locked_at", nullable=True),
    _at("revoked_at", nullable=True),
)
lock_outs = Table(
    "lock_outs",
    metadata,
    Column("subject", String, primary_key=True),
    Column("until_s", Float, nullable=False),
)
leases = Table(
    "leases",
    metadata,
    Column("case_id", ForeignKey("cases.id"), primary_key=True),
    Column("fencing_token", Integer, nullable=False),
    Column("session_id", ForeignKey("sessions.id"), nullable=False),
    Column("user_id", ForeignKey("users.id"), nullable=False),
    Column("reason", String, nullable=False),
    _at("taken_at"),
)
room_claims = Table(
    "room_claims",
    metadata,
    Column("room", String(64), primary_key=True),
    Column("holder", String, nullable=False),
    _at("claimed_at"),
)
idempotency_keys = Table(
    "idempotency_keys",
    metadata,
    Column("user_id", String, primary_key=True),
    Column("key", String(128), primary_key=True),
    Column("request_sha256", String(64), nullable=False),  # keyed: a body may hold a PIN
    Column("status", Integer, nullable=False),
    Column("body", JSON, nullable=False),
    Column("version", Integer),
    _at("created_at"),
)

# --- records ---------------------------------------------------------------------------------------------------------
cases = Table(
    "cases",
    metadata,
    _id(),
    Column("room", String(64), nullable=False),
    Column("patient_id", String, nullable=False),
    Column("study_uid", String, nullable=False),
    Column("opened_by", ForeignKey("users.id"), nullable=False),
    Column("product_version", String, nullable=False),
    Column("settings_sha256", String(64), nullable=False),
    Column("devices", JSON, nullable=False),
    _at("opened_at"),
    sa.Index("ix_cases_room_id", "room", "id"),
    sa.Index("ix_cases_opened_at_id", "opened_at", "id"),
)
planned_targets = Table(
    "planned_targets",
    metadata,
    Column("case_id", ForeignKey("cases.id"), primary_key=True),
    Column("name", String, primary_key=True),
    Column("content", JSON, nullable=False),
)
events = Table(
    "events",
    metadata,
    Column("case_id", ForeignKey("cases.id"), primary_key=True),
    Column("sequence", Integer, primary_key=True),
    Column("version", Integer, nullable=False),
    Column("trigger", String, nullable=False),
    Column("user_id", ForeignKey("users.id")),
    Column("state", String, nullable=False),
    Column("case_state", JSON, nullable=False),
    Column("data", JSON, nullable=False),
    _at(),
    # the cases that are over, which in the end is nearly all of them
    sa.Index("ix_events_over", "case_id", sqlite_where=_IS_OVER, postgresql_where=_IS_OVER),
)
audit_events = Table(
    "audit_events",
    metadata,
    _row_number(),
    Column("kind", String, nullable=False),
    Column("user_id", String),
    Column("data", JSON, nullable=False),
    _at(),
    sa.Index("ix_audit_events_kind_id", "kind", "id"),
)
attempts = Table(
    "attempts",
    metadata,
    _row_number(),
    _case(nullable=True),
    Column("user_id", String),
    Column("trigger", String, nullable=False),
    Column("accepted", Boolean, nullable=False),
    Column("code", String, nullable=False),
    Column("message", String, nullable=False),
    Column("state", String),
    _at(),
)
verdicts = Table(
    "verdicts",
    metadata,
    _row_number(),
    Column("attempt_id", ForeignKey("attempts.id"), nullable=False, index=True),
    Column("code", String, nullable=False),
    Column("hazard", String, nullable=False),
    Column("passed", Boolean, nullable=False),
    Column("measured", _OptionalJson),
    Column("limit", _OptionalJson),
    Column("unit", String, nullable=False),
    Column("message", String, nullable=False),
    sa.Index("ix_verdicts_code_attempt_id", "code", "attempt_id"),
    sa.Index("ix_verdicts_hazard_attempt_id", "hazard", "attempt_id"),
)
device_files = Table(
    "device_files",
    metadata,
    _id(),
    Column("kind", String(8), nullable=False),
    Column("name", String, nullable=False),
    Column("version", String, nullable=False),
    Column("sha256", String(64), nullable=False),
    Column("expires", String(10)),
    Column("content", LargeBinary, nullable=False),
    Column("uploaded_by", ForeignKey("users.id"), nullable=False),
    Column("position", Integer, nullable=False, unique=True),
    _at("uploaded_at"),
    sa.UniqueConstraint("kind", "name", "version"),
)
image_bytes = Table(
    "image_bytes",
    metadata,
    Column("sha256", String(64), primary_key=True),
    Column("content", LargeBinary, nullable=False),
)
images = Table(
    "images",
    metadata,
    _id(),
    Column("position", Integer, nullable=False, unique=True),
    Column("sha256", ForeignKey("image_bytes.sha256"), nullable=False, index=True),
    Column("sop_uid", String, index=True),
    Column("pixel_sha256", String(64), index=True),
    Column("duplicate_of", ForeignKey("images.id")),
    Column("patient_id", String),
    Column("study_uid", String),
    Column("problem", _OptionalJson),
    Column("source", JSON, nullable=False),
    Column("metadata", JSON, nullable=False),
    _at("received_at"),
)
image_purposes = Table(
    "image_purposes",
    metadata,
    Column("image_id", ForeignKey("images.id"), primary_key=True),
    _case(nullable=True),
    Column("purpose", String, nullable=False),
    Column("arm", JSON, nullable=False),
    Column("verdicts", JSON, nullable=False),
    _at(),
)
registrations = _artefact("registrations", Column("image_id", ForeignKey("images.id"), nullable=False))
targets = _artefact("targets")
plans = _artefact("plans")
permits = _artefact("permits", Column("approved_by", ForeignKey("users.id"), nullable=False))
# A permit is single use: its use has the permit's own id as primary key.
permit_uses = _artefact("permit_uses", sa.ForeignKeyConstraint(["id"], ["permits.id"]))
motions = _artefact("motions", Column("trajectory", LargeBinary))
evaluations = _artefact("evaluations", Column("image_id", ForeignKey("images.id"), nullable=False))
insertions = _artefact("insertions")
# What a person says that an image is for; of several, the one with the greatest number counts.
image_assignments = _artefact(
    "image_assignments",
    Column("image_id", ForeignKey("images.id"), nullable=False),
    Column("number", Integer, nullable=False),
    sa.UniqueConstraint("image_id", "number"),
)
outgoing_objects = Table(
    "outgoing_objects",
    metadata,
    _id(),  # the SOP instance UID
    _case(),
    Column("kind", String(24), nullable=False),
    Column("sop_class", String(64), nullable=False),
    Column("sha256", ForeignKey("image_bytes.sha256"), nullable=False),
    _at("queued_at"),
)
deliveries = Table(
    "deliveries",
    metadata,
    _row_number(),
    Column("object_id", ForeignKey("outgoing_objects.id"), nullable=False, index=True),
    Column("accepted", Boolean, nullable=False),
    Column("answer", String, nullable=False),
    _at(),
)

# --- the ledger over the records -------------------------------------------------------------------------------------
# `entry` is what is hashed; the columns behind it repeat parts of it to be searched by.
ledger = Table(
    "ledger",
    metadata,
    Column("sequence", _RowNumber, primary_key=True, autoincrement=False),
    Column("entry", Text, nullable=False),
    Column("sha256", String(64), nullable=False),
    Column("reached_at", String(32), nullable=False, index=True),
    Column("case_id", String),
    Column("actor", String),
    Column("action", String, nullable=False),
    Column("attempt_id", _RowNumber, unique=True),
    sa.Index("ix_ledger_case_id_sequence", "case_id", "sequence"),
    sa.Index("ix_ledger_actor_sequence", "actor", "sequence"),
    sa.Index("ix_ledger_action_sequence", "action", "sequence"),
)
checkpoints = Table(
    "checkpoints",
    metadata,
    Column("sequence", ForeignKey("ledger.sequence"), primary_key=True, autoincrement=False),
    Column("statement", Text, nullable=False),
    Column("signature", String(128), nullable=False),
)

RECORDS: tuple[Table, ...] = (
    cases,
    planned_targets,
    events,
    audit_events,
    attempts,
    verdicts,
    device_files,
    image_bytes,
    images,
    image_purposes,
    registrations,
    targets,
    plans,
    permits,
    permit_uses,
    motions,
    evaluations,
    insertions,
    image_assignments,
    outgoing_objects,
    deliveries,
)
LEDGER: tuple[Table, ...] = (ledger, checkpoints)
MUTABLE: tuple[Table, ...] = (users, sessions, lock_outs, leases, room_claims, idempotency_keys)

"""the ledger over the records."""

import sqlalchemy as sa
from alembic import op
from migrations.append_only import make_append_only


revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None

_ROW_NUMBER = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    """Tables and indices; what the records held before is taken into the ledger once the schema is whole."""
    op.create_table(
        "ledger",
        sa.Column("sequence", _ROW_NUMBER, autoincrement=False, nullable=False),
        sa.Column("entry", sa.Text(), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("reached_at", sa.String(length=32), nullable=False),
        sa.Column("case_id", sa.String(), nullable=True),
        sa.Column("actor", sa.String(), nullable=True),
        sa.Column("action", sa.String(), nullable=False),
        sa.Column("attempt_id", _ROW_NUMBER, nullable=True),
        sa.PrimaryKeyConstraint("sequence", name=op.f("pk_ledger")),
        sa.UniqueConstraint("attempt_id", name=op.f("uq_ledger_attempt_id")),
    )
    op.create_index(op.f("ix_ledger_reached_at"), "ledger", ["reached_at"], unique=False)
    for column in ("case_id", "actor", "action"):
        op.create_index(op.f(f"ix_ledger_{column}_sequence"), "ledger", [column, "sequence"], unique=False)
    for column in ("code", "hazard"):
        op.create_index(op.f(f"ix_verdicts_{column}_attempt_id"), "verdicts", [column, "attempt_id"], unique=False)
    op.create_table(
        "checkpoints",
        sa.Column("sequence", _ROW_NUMBER, autoincrement=False, nullable=False),
        sa.Column("statement", sa.Text(), nullable=False),
        sa.Column("signature", sa.String(length=128), nullable=False),
        sa.ForeignKeyConstraint(["sequence"], ["ledger.sequence"], name=op.f("fk_checkpoints_sequence")),
        sa.PrimaryKeyConstraint("sequence", name=op.f("pk_checkpoints")),
    )
    make_append_only(("ledger", "checkpoints"))

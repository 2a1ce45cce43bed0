"""what a case leaves to the hospital's archive."""

import sqlalchemy as sa
from alembic import op
from migrations.append_only import make_append_only


revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None

_ROW_NUMBER = sa.BigInteger().with_variant(sa.Integer(), "sqlite")


def upgrade() -> None:
    """The objects, and the archive's answers to each."""
    op.create_table(
        "outgoing_objects",
        sa.Column("id", sa.String(), nullable=False),
        sa.Column("case_id", sa.String(), nullable=False),
        sa.Column("kind", sa.String(length=24), nullable=False),
        sa.Column("sop_class", sa.String(length=64), nullable=False),
        sa.Column("sha256", sa.String(length=64), nullable=False),
        sa.Column("queued_at", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["case_id"], ["cases.id"], name=op.f("fk_outgoing_objects_case_id")),
        sa.ForeignKeyConstraint(["sha256"], ["image_bytes.sha256"], name=op.f("fk_outgoing_objects_sha256")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_outgoing_objects")),
    )
    op.create_index(op.f("ix_outgoing_objects_case_id"), "outgoing_objects", ["case_id"], unique=False)
    op.create_table(
        "deliveries",
        sa.Column("id", _ROW_NUMBER, autoincrement=True, nullable=False),
        sa.Column("object_id", sa.String(), nullable=False),
        sa.Column("accepted", sa.Boolean(), nullable=False),
        sa.Column("answer", sa.String(), nullable=False),
        sa.Column("recorded_at", sa.String(length=32), nullable=False),
        sa.ForeignKeyConstraint(["object_id"], ["outgoing_objects.id"], name=op.f("fk_deliveries_object_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_deliveries")),
    )
    op.create_index(op.f("ix_deliveries_object_id"), "deliveries", ["object_id"], unique=False)
    make_append_only(("outgoing_objects", "deliveries"))

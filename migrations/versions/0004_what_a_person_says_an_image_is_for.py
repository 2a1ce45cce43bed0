"""what a person says an image is for."""

import sqlalchemy as sa
from alembic import op
from migrations.append_only import make_append_only


revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Assignments of images; the newest of an image counts."""
    op.create_table(
        "image_assignments",
        sa.Column("id", sa.String(), nullable=False),
        sa.Column("case_id", sa.String(), nullable=False),
        sa.Column("sequence", sa.Integer(), nullable=False),
        sa.Column("made_from", sa.JSON(), nullable=False),
        sa.Column("content", sa.JSON(), nullable=False),
        sa.Column("recorded_at", sa.String(length=32), nullable=False),
        sa.Column("image_id", sa.String(), nullable=False),
        sa.Column("number", sa.Integer(), nullable=False),
        sa.ForeignKeyConstraint(
            ["case_id", "sequence"],
            ["events.case_id", "events.sequence"],
            name=op.f("fk_image_assignments_case_id_sequence"),
        ),
        sa.ForeignKeyConstraint(["image_id"], ["images.id"], name=op.f("fk_image_assignments_image_id")),
        sa.PrimaryKeyConstraint("id", name=op.f("pk_image_assignments")),
        sa.UniqueConstraint("image_id", "number", name=op.f("uq_image_assignments_image_id_number")),
    )
    make_append_only(("image_assignments",))

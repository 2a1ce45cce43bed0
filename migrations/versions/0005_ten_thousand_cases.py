"""ten thousand cases: indexes for what is asked of all of them."""

import sqlalchemy as sa
from alembic import op


revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None

_ARTEFACTS = (
    "registrations",
    "targets",
    "plans",
    "permits",
    "permit_uses",
    "motions",
    "evaluations",
    "insertions",
    "image_assignments",
)


def upgrade() -> None:
    """No row changes."""
    for table in _ARTEFACTS:
        op.create_index(f"ix_{table}_case_id_sequence", table, ["case_id", "sequence"])
    over = sa.text("state IN ('closed', 'aborted')")
    op.create_index("ix_events_over", "events", ["case_id"], sqlite_where=over, postgresql_where=over)
    op.create_index("ix_cases_room_id", "cases", ["room", "id"])
    op.create_index("ix_cases_opened_at_id", "cases", ["opened_at", "id"])
    op.create_index("ix_audit_events_kind_id", "audit_events", ["kind", "id"])

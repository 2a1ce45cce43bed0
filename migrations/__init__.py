"""The schema's history (alembic), run when the service starts."""

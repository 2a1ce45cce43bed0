"""Runs the migrations on the connection, and in the transaction, that `service.database.migrate` hands over."""

from alembic import context

from service.database.tables import metadata

context.configure(
    connection=context.config.attributes["connection"],
    target_metadata=metadata,
    # SQLite can roll back DDL once the driver leaves transactions alone; an interrupted upgrade leaves nothing.
    transactional_ddl=True,
    render_as_batch=False,
)
context.run_migrations()

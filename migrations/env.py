"""Runs the migrations on the connection, and in the transaction, that `service.database.migrate` hands over.

That transaction is what makes an upgrade atomic, DDL included, on SQLite too: its driver begins and commits nothing.
"""

from alembic import context

from service.database.tables import metadata

context.configure(connection=context.config.attributes["connection"], target_metadata=metadata)
context.run_migrations()

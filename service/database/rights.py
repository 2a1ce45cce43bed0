"""Rights on PostgreSQL: the role that a service signs in with adds records and changes none.

The owner of the tables upgrades them and keeps every right; foreign keys are checked in its name. SQLite has no roles.
"""

from sqlalchemy.engine import Connection

from service.database import tables


def grant_rights(connection: Connection, role: str) -> None:
    """Give a role what a service needs, and take back what it must not have; run by the owner of the tables."""
    quoted = connection.dialect.identifier_preparer.quote(role)
    kept = ", ".join(table.name for table in (*tables.RECORDS, *tables.LEDGER))
    mutable = ", ".join(table.name for table in tables.MUTABLE)
    for statement in (
        f"REVOKE ALL ON {kept} FROM {quoted}",
        f"GRANT SELECT, INSERT ON {kept} TO {quoted}",
        f"GRANT SELECT, INSERT, UPDATE, DELETE ON {mutable} TO {quoted}",
        f"GRANT SELECT ON alembic_version TO {quoted}",
        f"GRANT USAGE, SELECT ON ALL SEQUENCES IN SCHEMA public TO {quoted}",
    ):
        connection.exec_driver_sql(statement)

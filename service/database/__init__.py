"""The database: engines, tables, migrations, free space."""

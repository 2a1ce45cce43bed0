"""When `make evidence` says that a flipped bit has changed the record."""

import sqlite3
from contextlib import closing

import pytest

from benchmarks.evidence.tampering import is_changed, rows_of
from tests.databases import file_of


@pytest.mark.sqlite
def test_rows_that_nobody_can_read_any_more_count_as_changed(databases, tmp_path):
    with databases.migrated(tmp_path) as address:
        file = file_of(address)
        rows = rows_of(file)
        assert not is_changed(file, rows)
        content = file.read_bytes()
        assert b"\tcontent BLOB" in content
        file.write_bytes(content.replace(b"\tcontent BLOB", b"\tc\xefntent BLOB"))
        with pytest.raises(UnicodeDecodeError), closing(sqlite3.connect(file)) as connection:
            connection.execute("SELECT * FROM image_bytes")
        assert is_changed(file, rows)

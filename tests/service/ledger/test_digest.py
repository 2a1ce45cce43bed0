"""The hash of a row: one for one content, whatever order and however many columns come later."""

import pytest
import sqlalchemy as sa

from service.ledger.rows import digest

_TABLE = sa.Table("t", sa.MetaData(), sa.Column("id", sa.Integer, primary_key=True), sa.Column("a", sa.Text))
_LATER = sa.Table(
    "t",
    sa.MetaData(),
    sa.Column("id", sa.Integer, primary_key=True),
    sa.Column("a", sa.Text),
    sa.Column("added", sa.Text),
)


def test_a_column_that_is_added_behind_the_others_changes_no_hash():
    assert digest(_LATER, [(1, "x", None)]) == digest(_TABLE, [(1, "x")])
    assert digest(_LATER, [(1, None, None)]) == digest(_TABLE, [(1, None)])
    assert digest(_LATER, [(1, None, "x")]) != digest(_TABLE, [(1, "x")])


def test_rows_of_a_group_hash_alike_in_every_order():
    rows = [(number, str(number)) for number in range(1, 12)]
    assert digest(_TABLE, rows) == digest(_TABLE, rows[::-1])
    assert digest(_TABLE, rows) != digest(_TABLE, rows[1:])


@pytest.mark.parametrize(("one", "other"), [("1", 1), ("", None), (b"x", "x"), (1, 1.5), ("a\x00b", "ab")])
def test_values_of_different_kinds_hash_differently(one, other):
    assert digest(_TABLE, [(1, one)]) != digest(_TABLE, [(1, other)])

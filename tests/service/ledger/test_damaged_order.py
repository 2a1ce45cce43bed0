"""A damaged file can lead a walk along its entries back to where it was, or give it what no column may hold."""

from types import SimpleNamespace

import pytest

from service.ledger.chain_check import ChainCheck
from service.ledger.entries import REPEATED
from service.ledger.findings import Verification

_COLUMNS = tuple("x" for _ in REPEATED)
_EARLIER = (3, *_COLUMNS, "no text", "no hash", "2026")
_NO_TIME = (6, *_COLUMNS, "no text", "no hash", None)


def _answering(row, reached_at):
    """A connection that has this row behind entry 5, whatever is asked for."""
    answer = SimpleNamespace(first=lambda: (5, "f" * 64, reached_at), cursor=SimpleNamespace(fetchall=lambda: [row]))
    return SimpleNamespace(execute=lambda _query, _values=None: answer)


@pytest.mark.parametrize("reached_at", ["2026", None])
@pytest.mark.parametrize("row", [_EARLIER, _NO_TIME])
def test_a_walk_through_a_damaged_file_ends_with_a_finding(row, reached_at):
    verification = Verification()
    assert len(list(ChainCheck(_answering(row, reached_at), verification, 6, 9).entries())) <= 2
    assert any("the file is damaged" in finding.what for finding in verification.findings)

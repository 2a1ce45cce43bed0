"""A damaged file can lead a walk along its entries back to where it was."""

from types import SimpleNamespace

from service.ledger.chain_check import ChainCheck
from service.ledger.entries import REPEATED
from service.ledger.findings import Verification

_EARLIER = (3, *("x" for _ in REPEATED), "no text", "no hash", "2026")


def _circle(_query, _values=None):
    """Whatever is asked for behind entry 5 is entry 3."""
    return SimpleNamespace(first=lambda: (5, "f" * 64, "2026"), cursor=SimpleNamespace(fetchall=lambda: [_EARLIER]))


def test_a_walk_that_is_led_back_ends_with_a_finding():
    verification = Verification()
    walk = ChainCheck(SimpleNamespace(execute=_circle), verification, 6, 9)
    assert len(list(walk.entries())) == 1
    assert any("the file is damaged" in finding.what for finding in verification.findings)

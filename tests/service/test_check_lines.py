"""Items of a check as lines of text."""

import pytest

from service.cli.check_lines import tell


def test_a_limit_in_radians_is_told_with_as_many_digits_as_what_was_measured(
    capsys: pytest.CaptureFixture[str],
) -> None:
    one = {"code": "tcp_rad", "passed": False, "measured": 0.0349065850398865, "limit": 0.017453292519943295}
    tell([one | {"unit": "rad", "what_to_do": "Set the TCP."}])
    assert capsys.readouterr().out == "FAIL  tcp_rad: 0.0349 (limit 0.0175) rad. Set the TCP.\n"

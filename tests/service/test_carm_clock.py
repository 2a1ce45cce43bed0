"""The C-arm's own clock as images tell it (H02): a time that is none is unknown, and breaks nothing."""

import pytest

from service.conductor.arrival import _carm_time


@pytest.mark.parametrize("time", ["123456-0500", "12:34:56", "123456x", "1234", "²²²²²²", "", None])
def test_a_time_of_another_form_is_unknown(time):
    assert _carm_time({"acquisition_date": "20260314", "acquisition_time": time}) is None


def test_later_is_later_across_fractions_and_days():
    times = [("20260314", "235959"), ("20260314", "235959.25 "), ("20260315", "000000.5")]
    told = [_carm_time({"acquisition_date": day, "acquisition_time": time}) for day, time in times]
    assert None not in told
    assert sorted(told) == told
    assert len(set(told)) == 3


def test_the_content_speaks_where_the_acquisition_does_not():
    metadata = {"acquisition_date": "20260314", "content_date": "20260314", "content_time": "101112"}
    assert _carm_time(metadata) == ("20260314", 10 * 3600 + 11 * 60 + 12.0)

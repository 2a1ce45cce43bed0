"""Many hands and one permit, over the service's own sockets: one motion. `make evidence` contests 10,000 of them."""

import pytest

from benchmarks.states.races import MOST, races

_PERMITS = (1, 3, 5)  # with 10, 17 and 41 clients


@pytest.mark.hazard("H14", "H15")
def test_a_permit_that_many_hold_at_once_starts_one_motion(tmp_path, databases):
    with databases.empty(tmp_path) as address:
        trials = list(races(tmp_path, _PERMITS, address))
    assert len(trials) == len(_PERMITS)
    assert max(trial["clients"] for trial in trials) > MOST // 2
    assert [trial for trial in trials if trial["bad"]] == []

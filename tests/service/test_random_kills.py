"""What `make evidence` calls bad about a service that was killed, and how the next one is started."""

from dataclasses import replace

import pytest

from benchmarks.states.kills import Acknowledged, KilledService, _against
from benchmarks.stop.forked_service import ForkedService
from service.cases.records import StoredEvent
from tests.system.service_process import Service


def _event(sequence, trigger, **data):
    return StoredEvent("c", sequence, sequence, trigger, "u", "case_open", {}, data, "2026-01-05T12:00:00Z")


_BEFORE = [_event(1, "opened"), _event(2, "note", text="one"), _event(3, "hold_requested")]
_AFTER = [*_BEFORE, _event(4, "restarted"), _event(5, "note", text="two"), _event(6, "acknowledged")]
_SAID = Acknowledged(events=[(2, "note"), (3, "hold_requested"), (5, "note")], said=["one", "two"])


def test_what_was_acknowledged_is_there_once_behind_a_kill():
    assert _against(_SAID, _BEFORE, _AFTER) == ""


@pytest.mark.parametrize(
    ("after", "said"),
    [
        ([*_AFTER[:4], *_AFTER[5:]], "numbers are missing or there twice"),
        ([*_AFTER, _AFTER[-1]], "numbers are missing or there twice"),
        (_AFTER[:4], "acknowledged and lost: [(5, 'note')]"),
        ([replace(_AFTER[0], user_id="v"), *_AFTER[1:]], "what was recorded changed, or no restart behind it"),
        ([*_BEFORE, replace(_AFTER[3], trigger="note"), *_AFTER[4:]], "what was recorded changed, or no restart"),
        ([*_AFTER, _event(7, "note", text="two")], "said once, recorded otherwise: ['two']"),
    ],
)
def test_a_record_that_lost_changed_or_repeated_something_is_bad(after, said):
    assert _against(_SAID, _BEFORE, after).startswith(said)


def test_the_first_service_and_every_twentieth_is_started_whole_and_ended_as_it_was_started(tmp_path, monkeypatch):
    done = []
    for kind in (Service, ForkedService):
        for what in ("start", "kill", "end"):
            monkeypatch.setattr(kind, what, lambda _, name=f"{what} {kind.__name__}": done.append(name))
    service = KilledService(tmp_path, None, "", nursery=None)
    for _ in range(21):
        service.start()
        service.kill()
    service.end()
    whole, forked = ["start Service", "kill Service"], ["start ForkedService", "kill ForkedService"]
    assert done == [*whole, *forked * 19, *whole, "end Service"]
    assert service.started == "started whole"

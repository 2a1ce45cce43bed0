"""SIGKILL at any moment of writing: what was acknowledged is there, whole, and nothing else is half there (H25)."""

import random
import subprocess
import sys
import time

import pytest

from service.auth.permissions import Role
from service.cases import store
from service.cases.records import ArtefactKind, NewCase, NewEvent

_KILLS = 6

# Appends events with an artefact each and acknowledges a sequence number only once its transaction is over.
_WRITER = """
import sys
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact, NewEvent
from service.database.engines import open_database
database = open_database(sys.argv[1])
while True:
    with database.write() as connection:
        before = store.newest_event(connection, "case-1")
        motion = NewArtefact(ArtefactKind.MOTION, f"m{before.sequence + 1}", (), {}, {"trajectory": bytes(50_000)})
        event = NewEvent("arrived", None, "moved", {}, {})
        stored = store.append(connection, "case-1", event, expected_version=before.version, artefacts=[motion])
    print(stored.sequence, flush=True)
"""


@pytest.mark.hazard("H25")
@pytest.mark.parametrize("seed", range(_KILLS))
def test_no_acknowledged_event_is_lost_and_none_is_half_there(database, users, seed):
    surgeon = users.add("anna", Role.SURGEON, "correct horse", "2468")
    case = NewCase("case-1", "room-1", "P1", "1.2.3", surgeon.id, "0" * 64, {}, {})
    with database.write() as connection:
        store.open_case(connection, case, NewEvent("case_opened", None, "case_open", {}, {}))
    command = [sys.executable, "-c", _WRITER, str(database.writer.url)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as writer:
        first = int(writer.stdout.readline())
        time.sleep(random.Random(seed).uniform(0.0, 0.3))
        writer.kill()
        acknowledged = [first, *(int(line) for line in writer.stdout if line.endswith("\n"))]
    with database.read() as connection:
        events = store.events_after(connection, "case-1", limit=100_000)
        motions = store.artefacts_of(connection, ArtefactKind.MOTION, "case-1")
        if connection.dialect.name == "sqlite":
            assert connection.exec_driver_sql("PRAGMA integrity_check").scalar() == "ok"
    assert [event.sequence for event in events] == list(range(1, len(events) + 1))
    assert len(events) >= acknowledged[-1], "an acknowledged event is lost"
    assert [motion.sequence for motion in motions] == [event.sequence for event in events[1:]]
    with database.write() as connection:
        store.append(connection, "case-1", NewEvent("restarted", None, "safe_hold", {}, {}), expected_version=None)

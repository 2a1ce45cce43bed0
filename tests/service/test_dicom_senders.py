"""Several senders at once, killed senders, a full disk, a busy database: what was acknowledged is stored, once."""

import hashlib
import sqlite3
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path

import pytest
from pydicom import dcmread

from benchmarks.four_senders import Permits
from service.database import engines
from service.database.engines import Database, open_database
from service.database.free_space import check_free_space
from service.images import store
from service.images.arrivals import ImageArrivals
from service.images.receiver import DicomReceiver
from service.settings import DicomSettings

_SENDERS, _EACH = 4, 6
# A permit waits for one image at most, some 20 ms; the rest is for a machine on which much else runs.
_PATIENCE_S = 1.0


@dataclass
class Room:
    """A receiver at work, and storescu as processes of its own."""

    port: int
    database: Database
    program: str

    def send(self, files: list[Path]) -> "subprocess.Popen[str]":
        command = [self.program, "-v", "-aet", "CARM", "127.0.0.1", str(self.port), *map(str, files)]
        return subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)

    def stored(self) -> dict[str, store.StoredImage]:
        """By SOP instance UID, which no two have."""
        with self.database.read() as connection:
            images = store.list_images(connection)
        by_uid = {image.sop_uid: image for image in images}
        assert len(by_uid) == len(images)
        return by_uid

    def pixels(self, image: store.StoredImage) -> bytes:
        with self.database.read() as connection:
            return dcmread(BytesIO(store.original_bytes(connection, image.id))).PixelData


@pytest.fixture
def room(database, storescu) -> Iterator[Callable[..., Room]]:
    with ExitStack() as stack:

        def start(check_room: Callable[[], None] = lambda: None, at: Database = database) -> Room:
            settings = DicomSettings(port=0, accepted_callers=("CARM",))
            receiver = DicomReceiver(settings, at, ImageArrivals(), check_room)
            return Room(stack.enter_context(receiver.listening()), at, storescu)

        yield start


@pytest.fixture
def files(make_xray, tmp_path) -> Callable[[int, int], list[Path]]:
    def write(sender: int, count: int, side: int = 512) -> list[Path]:
        made = [tmp_path / f"{sender}-{number}.dcm" for number in range(count)]
        for number, file in enumerate(made):
            file.write_bytes(make_xray(side, side, seed=1000 * sender + number))
        return made

    return write


def _acknowledged(output: str) -> int:
    return output.count("Received Store Response (Success)")


def test_four_senders_at_once_lose_nothing_and_hold_no_permit_up(room, files):
    running, of_senders = room(), [files(sender, _EACH) for sender in range(_SENDERS)]
    permits = Permits(running.database)
    senders = [running.send(one) for one in of_senders]
    waits_s = []
    while any(sender.poll() is None for sender in senders):
        waits_s.append(1e-3 * permits.commit(len(waits_s)).wait_ms)
        time.sleep(0.02)
    assert [_acknowledged(sender.communicate()[0]) for sender in senders] == [_EACH] * _SENDERS
    assert max(waits_s) < _PATIENCE_S
    stored = running.stored()
    for file in (file for one in of_senders for file in one):
        sent = dcmread(file)
        assert running.pixels(stored[sent.SOPInstanceUID]) == sent.PixelData
    assert sorted(image.position for image in stored.values()) == list(range(1, _SENDERS * _EACH + 1))


def test_senders_that_are_killed_leave_whole_images_and_a_retry_ends_what_they_began(room, files):
    running, sent = room(), files(0, 30)
    kills = 0
    for delay_s in (0.03, 0.08, 0.15, 0.3):
        sender = running.send(sent)
        time.sleep(delay_s)
        kills += sender.poll() is None
        sender.kill()
        sender.communicate()
    assert kills > 0, "some sender was cut off"
    for image in running.stored().values():
        assert image.problem is None
        assert hashlib.sha256(running.pixels(image)).hexdigest() == image.pixel_sha256
    again = running.send(sent)
    assert _acknowledged(again.communicate(timeout=60)[0]) == len(sent)
    assert {dcmread(file).SOPInstanceUID for file in sent} == running.stored().keys()


def test_of_a_set_that_ends_early_is_stored_what_was_acknowledged(room, files):
    running, sent = room(), files(0, 6)
    sent[3].write_bytes(sent[3].read_bytes()[:-200_000])
    told = running.send(sent).communicate(timeout=60)[0]
    stored = running.stored()
    assert _acknowledged(told) == sum(image.problem is None for image in stored.values()) == 3
    assert {dcmread(file).SOPInstanceUID for file in sent[:3]} <= stored.keys()


@pytest.mark.hazard("H24")
def test_a_disk_that_is_nearly_full_is_answered_with_failure_and_the_image_comes_later(room, files, tmp_path):
    full = True

    def check() -> None:
        check_free_space(tmp_path, 10**18 if full else 0)

    running, sent = room(check), files(0, 1)
    told = running.send(sent).communicate(timeout=60)[0]
    assert "OutOfResources" in told
    assert running.stored() == {}
    full = False
    assert _acknowledged(running.send(sent).communicate(timeout=60)[0]) == 1


@pytest.mark.sqlite
def test_a_database_that_another_process_holds_is_answered_with_failure_and_the_image_comes_later(
    room, files, database, monkeypatch
):
    monkeypatch.setattr(engines, "BUSY_S", 0.2)
    impatient = open_database(database.writer.url.render_as_string(hide_password=False))
    running, sent = room(at=impatient), files(0, 1)
    with database.write():
        held = running.send(sent)
        told = held.communicate(timeout=60)[0]
    assert "OutOfResources" in told
    assert running.stored() == {}
    assert _acknowledged(running.send(sent).communicate(timeout=60)[0]) == 1
    assert len(running.stored()) == 1
    impatient.close()


@pytest.mark.sqlite
def test_a_log_that_cannot_be_emptied_makes_no_stored_image_fail(room, files, monkeypatch):
    def fail(connection) -> None:
        connection.close()
        raise sqlite3.OperationalError("database or disk is full")

    monkeypatch.setattr(engines, "closing", fail)
    running = room()
    assert _acknowledged(running.send(files(0, 2)).communicate(timeout=60)[0]) == 2
    assert len(running.stored()) == 2

"""The journal on a disk that works, is cut short, and fails."""

import json
from io import FileIO
from pathlib import Path
from threading import Event
from threading import enumerate as enumerate_threads

import pytest

from robot.arm import ArmState
from robot.guard.client import GuardConfig
from robot.guard.guard import STATUS_S
from robot.guard.journal import EVENTS_FILE, FLUSH_S, Journal, read_lines, trajectory_file
from robot.guard.messages import Acknowledge, Fault, FaultKind

FAULT = Fault(FaultKind.ARM_OFF, 1.0, "off")
PATIENCE_S = 20.0


class Narrow(FileIO):
    """A file on a disk with room for ten bytes."""

    def write(self, line: bytes) -> int:
        return super().write(line[:10])


def test_events_and_readings_are_on_the_disk_after_a_flush(tmp_path: Path, reading: ArmState) -> None:
    journal = Journal(tmp_path / "new")
    journal.record(FAULT)
    journal.sample("p", reading)
    journal.sample("p", reading)
    assert journal.flush(5.0)
    assert [line["type"] for line in read_lines(tmp_path / "new" / EVENTS_FILE)] == ["fault"]
    samples = read_lines(tmp_path / "new" / trajectory_file("p"))
    assert [sample["joints_rad"] for sample in samples] == [reading.joints_rad.tolist()] * 2
    journal.close()


def test_journal_goes_on_after_a_line_that_a_crash_cut_short(tmp_path: Path) -> None:
    (tmp_path / EVENTS_FILE).write_bytes(b'{"type":"fault","at_s":1.0}\n{"type":"mot')
    journal = Journal(tmp_path)
    journal.record(Acknowledge())
    journal.close()
    assert [line["type"] for line in read_lines(tmp_path / EVENTS_FILE)] == ["fault", "acknowledge"]


def test_flush_tells_that_something_was_not_written(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("in the way of the folder")
    journal = Journal(blocked)
    journal.record(FAULT)
    assert not journal.flush(5.0)
    blocked.unlink()
    journal.record(FAULT)
    assert journal.flush(5.0)  # the disk is well again
    journal.close()


@pytest.mark.hazard("H24")
def test_full_disk_is_told(tmp_path: Path) -> None:
    (tmp_path / EVENTS_FILE).symlink_to("/dev/full")
    journal = Journal(tmp_path)
    journal.record(FAULT)
    assert not journal.flush(5.0)
    journal.close()


@pytest.mark.hazard("H24")
def test_a_line_that_the_disk_took_in_part_is_told_and_the_next_one_is_whole(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with monkeypatch.context() as patch:
        patch.setattr("robot.guard.journal.FileIO", Narrow)
        journal = Journal(tmp_path)
        journal.record(FAULT)
        assert not journal.flush(PATIENCE_S)
    journal.record(FAULT)
    assert journal.flush(PATIENCE_S)
    assert [line["type"] for line in read_lines(tmp_path / EVENTS_FILE)] == ["fault"]
    journal.close()


def test_a_guard_that_fails_is_not_kept_alive_by_its_journal(tmp_path: Path) -> None:
    journal = Journal(tmp_path)
    assert [thread.daemon for thread in enumerate_threads() if thread.name == "journal"] == [True]
    journal.close()


def test_nothing_written_yet_reads_as_nothing(tmp_path: Path) -> None:
    assert read_lines(tmp_path / EVENTS_FILE) == []


@pytest.mark.parametrize("rubbish", [b"\x00\x00\x00\n", b"3\n", b"[1]\n"])
def test_rubbish_in_the_journal_is_left_out(tmp_path: Path, rubbish: bytes) -> None:
    (tmp_path / EVENTS_FILE).write_bytes(rubbish + json.dumps({"type": "fault"}).encode() + b"\n")
    assert read_lines(tmp_path / EVENTS_FILE) == [{"type": "fault"}]


def test_a_line_of_the_journal_is_added_to_those_of_an_earlier_guard(tmp_path: Path) -> None:
    for _ in range(2):
        journal = Journal(tmp_path)
        journal.record(FAULT)
        journal.close()
    content = (tmp_path / EVENTS_FILE).read_bytes()
    assert content.count(b"\n") == 2  # and no empty one between them
    assert [line["type"] for line in read_lines(tmp_path / EVENTS_FILE)] == ["fault", "fault"]


def test_a_journal_makes_the_folders_that_it_needs(tmp_path: Path) -> None:
    journal = Journal(tmp_path / "of" / "the" / "room")
    journal.record(FAULT)
    assert journal.flush(5.0)
    journal.close()


@pytest.mark.hazard("H24")
def test_events_are_forced_to_the_disk_at_once_and_readings_by_a_flush(
    tmp_path: Path, reading: ArmState, monkeypatch: pytest.MonkeyPatch
) -> None:
    forced: list[str] = []

    def fsync(descriptor: int) -> None:
        forced.append(Path(f"/proc/self/fd/{descriptor}").readlink().name)

    monkeypatch.setattr("robot.guard.journal.os.fsync", fsync)
    journal = Journal(tmp_path)
    journal.sample("p", reading)
    journal.record(FAULT)
    assert journal.flush(5.0)
    assert forced[0] == EVENTS_FILE
    assert sorted(forced[1:]) == sorted([EVENTS_FILE, trajectory_file("p")])
    journal.close()


def test_a_guard_that_waits_for_its_disk_is_not_taken_for_frozen(tmp_path: Path) -> None:
    config = GuardConfig("127.0.0.1", tmp_path)
    assert config.silent_after_s > FLUSH_S + 4.0 * STATUS_S


def test_a_flush_that_takes_too_long_says_so(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    released = Event()
    monkeypatch.setattr("robot.guard.journal.os.fsync", lambda _: released.wait(20.0))
    journal = Journal(tmp_path)
    journal.record(FAULT)
    assert not journal.flush(0.01)
    released.set()
    assert journal.flush(20.0)
    journal.close()

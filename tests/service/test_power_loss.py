"""Power cuts, kills and full disks amid a whole case, on the system calls that it really makes (H25).

`make evidence` does all of them.
"""

import shutil
from random import Random

import pytest

from benchmarks.evidence import failing_calls
from benchmarks.evidence.disk import SECTOR, Disk, Loss
from benchmarks.evidence.inputs import prepare
from benchmarks.evidence.power_loss import cuts
from benchmarks.evidence.system_calls import Call, recorded
from benchmarks.evidence.whole_case import SMALL

_CUTS = 60


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("evidence")
    (folder / SMALL).mkdir()
    prepare(folder / SMALL, small=True)
    return folder


@pytest.fixture(scope="module")
def calls(folder):
    return _recorded(folder, folder / "data")


def _recorded(folder, victim, *pragmas):
    shutil.copytree(folder / SMALL, victim)
    return recorded(victim, pragmas)


def _cut(folder, calls, tmp_path):
    return list(cuts(folder / SMALL, calls, range(_CUTS), tmp_path / "cut"))


def test_no_power_cut_loses_what_was_acknowledged_or_leaves_half_of_anything(folder, calls, tmp_path):
    found = _cut(folder, calls, tmp_path)
    assert len(found) == _CUTS
    assert max(one.acknowledged for one in found) > 10
    assert [one for one in found if one.lost or one.corrupt] == []


def test_a_journal_that_is_synced_less_is_seen_to_lose(folder, tmp_path):
    calls = _recorded(folder, tmp_path / "data", "synchronous=NORMAL")
    assert sum(one.lost > 0 for one in _cut(folder, calls, tmp_path)) > _CUTS // 10


@pytest.mark.parametrize(
    ("name", "fault"),
    [(name, *failing_calls.KILLED) for name in ("pwrite64", "fdatasync", "unlink")]
    + [("pwrite64", "error=ENOSPC from then on"), ("fdatasync", "error=EIO")],
)
def test_a_write_a_sync_or_a_removal_that_is_the_last_or_fails_costs_nothing_acknowledged(folder, calls, name, fault):
    names = failing_calls.writing_calls(calls)
    (folder / failing_calls.CALLS).write_text("\n".join(names))
    (trial,) = failing_calls.trials(folder, [max(place for place, call in enumerate(names) if call == name)], [fault])
    assert trial["entries"] >= trial["acknowledged"] > 2
    assert not trial["bad"], trial["said"]


@pytest.fixture
def disk(tmp_path):
    (tmp_path / "old").write_bytes(b"o" * 2 * SECTOR)
    return Disk(tmp_path)


def _contents(disk, loss):
    return [disk.cut(loss, Random(seed)) for seed in range(40)]


def test_what_was_synced_survives_every_cut(disk):
    disk.do(Call("pwrite64", "old", b"n" * 2 * SECTOR))
    disk.do(Call("fdatasync", "old"))
    assert all(files == {"old": b"n" * 2 * SECTOR} for loss in Loss for files in _contents(disk, loss))


def test_what_was_not_synced_may_be_gone_there_or_torn_at_a_sector(disk):
    disk.do(Call("pwrite64", "old", b"n" * 2 * SECTOR))
    parts = (b"o" * SECTOR, b"n" * SECTOR)
    torn = {one["old"] for one in _contents(disk, Loss.TORN)}
    assert torn == {first + second for first in parts for second in parts}
    assert _contents(disk, Loss.DROPPED)[0]["old"] == 2 * parts[0]
    assert _contents(disk, Loss.KEPT)[0]["old"] == 2 * parts[1]


def test_a_later_write_may_reach_the_disk_before_an_earlier_one(disk):
    disk.do(Call("pwrite64", "old", b"1"))
    disk.do(Call("pwrite64", "old", b"2", number=SECTOR))
    pairs = {(one["old"][:1], one["old"][SECTOR : SECTOR + 1]) for one in _contents(disk, Loss.REORDERED)}
    assert (b"o", b"2") in pairs


@pytest.mark.parametrize("synced", [True, False])
def test_a_name_is_sure_once_its_folder_was_synced(disk, synced):
    disk.do(Call("openat", "part"))
    disk.do(Call("write", "part", b"new"))
    disk.do(Call("fsync", "part"))
    disk.do(Call("rename", "part", to="old"))
    if synced:
        disk.do(Call("fsync", ""))
    assert _contents(disk, Loss.DROPPED)[0] == {"old": b"new" if synced else b"o" * 2 * SECTOR}
    assert _contents(disk, Loss.KEPT)[0] == {"old": b"new"}

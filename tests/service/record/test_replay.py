"""Replay: the record is what its bytes give, to 1e-9, and whatever is not is named."""

import json
import sqlite3
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from typer.testing import CliRunner, Result

from service.cli.audit import audit
from service.database.engines import open_database
from service.database.migrate import migrate
from service.replay import crews
from service.replay.comparing import differences
from service.replay.crews import on_this_machine
from service.replay.inputs import CaseInput, CaseReplay
from service.settings import ArmAccuracy, Settings
from workflow.states import State

pytestmark = pytest.mark.usefixtures("remembered_jobs")
_RESULTS = 5  # of the recorded case: a registration, a target, two plans, an evaluation


@pytest.fixture
def replayed(site) -> Callable[..., Result]:
    def run(*arguments: str, case: bool = True) -> Result:
        which = [site.case_id] if case else []
        return CliRunner().invoke(audit, ["replay", *which, "--data-folder", str(site.folder), *arguments])

    return run


def _lines(result: Result) -> list[str]:
    return [line.partition(": ")[2] for line in result.stdout.splitlines() if line.startswith("case ")]


def test_an_untouched_case_is_equal_in_every_result(replayed, site) -> None:
    result = replayed()
    assert result.exit_code == 0, result.output
    assert f"1 cases, {_RESULTS} results" in result.stdout
    assert result.stdout.rstrip().endswith("all equal")
    with sqlite3.connect(site.folder / "coaxial.sqlite") as connection:
        kept = connection.execute("SELECT data FROM audit_events WHERE kind = 'record_replayed'").fetchone()[0]
    connection.close()
    assert json.loads(kept) == {"cases": site.case_id, "results": _RESULTS, "differences": 0}


def test_of_a_record_without_cases_nothing_is_said_to_be_equal(tmp_path) -> None:
    database = open_database(f"sqlite:///{tmp_path / 'coaxial.sqlite'}")
    migrate(database)
    database.close()
    result = CliRunner().invoke(audit, ["replay", "--all", "--data-folder", str(tmp_path)])
    assert "nothing to compute anew" in result.stdout, result.output
    assert "all equal" not in result.stdout


def _nudge(matrix: list[list[float]]) -> None:
    matrix[0][3] += 1e-6


@pytest.mark.parametrize(
    ("table", "change", "field"),
    [
        ("registrations", lambda one: _nudge(one["source_from_guide"]), "source_from_guide[0][3]"),
        ("registrations", lambda one: one["covariance"][9].__setitem__(9, 0.5), "covariance[9][9]"),
        ("targets", lambda one: _nudge(one["targeting"]["guide_from_goal"]), "guide_from_goal[0][3]"),
        ("plans", lambda one: _nudge(one["base_from_goal"]), "base_from_goal[0][3]"),
        ("evaluations", lambda one: one["contour"].update(position_error_mm=0.1), "contour.position_error_mm"),
    ],
)
def test_one_altered_figure_is_named_and_nothing_else(replayed, site, table, change, field) -> None:
    altered = site.alter(table, change)
    result = replayed()
    assert result.exit_code == 3
    (line,) = _lines(result)
    assert line.startswith(f"{table} {altered} {field}: recorded ")


def test_a_retreat_is_held_to_what_was_asked_for(replayed, site) -> None:
    def farther(connection: sqlite3.Connection) -> None:
        for plan_id, text in connection.execute("SELECT id, content FROM plans").fetchall():
            content = json.loads(text)
            if content["kind"] == "retreat":
                content["requested"]["distance_mm"] = 60.0
                connection.execute("UPDATE plans SET content = ? WHERE id = ?", (json.dumps(content), plan_id))

    site.attack(farther)
    assert any("base_from_goal[2][3]" in line for line in _lines(replayed()))


def test_an_altered_pose_of_an_exposure_shows_in_all_that_relies_on_it(replayed, site) -> None:
    def shift(connection: sqlite3.Connection) -> None:
        first = "SELECT image_id, arm FROM image_purposes JOIN images ON images.id = image_id ORDER BY position"
        image_id, text = connection.execute(first).fetchone()
        arm = json.loads(text)
        _nudge(arm["base_from_tcp"])
        connection.execute("UPDATE image_purposes SET arm = ? WHERE image_id = ?", (json.dumps(arm), image_id))

    site.attack(shift)
    assert {line.split()[0] for line in _lines(replayed())} == {"plans", "evaluations"}


@pytest.mark.parametrize("kind", ["guide", "carm", "tcp", "room"])
def test_other_device_bytes_are_named_by_their_hash(replayed, site, kind) -> None:
    change = f"UPDATE device_files SET content = CAST(content || x'0a' AS BLOB) WHERE kind = '{kind}'"
    site.attack(lambda connection: connection.execute(change))
    result = replayed()
    assert result.exit_code == 3
    assert _lines(result)[0].startswith("device_files ")
    assert " sha256: " in _lines(result)[0]


def test_other_image_bytes_are_named_and_do_not_end_the_replay(replayed, site) -> None:
    change = "UPDATE image_bytes SET content = x'00' WHERE length(content) > 100000"
    site.attack(lambda connection: connection.execute(change))
    lines = _lines(replayed())
    assert [line.split()[0] for line in lines[:2]] == ["images", "images"]
    assert any("registrations" in line and "refused: unreadable_image" in line for line in lines)
    assert any("evaluations" in line and "not to be computed" in line for line in lines)


def test_settings_that_are_not_in_the_record_are_the_present_ones_or_are_missed(replayed, site, tmp_path) -> None:
    site.attack(lambda connection: connection.execute("DELETE FROM image_bytes WHERE length(content) < 5000"))
    assert replayed().exit_code == 0
    other = Settings(arm_accuracy=ArmAccuracy(position_sd_mm=0.3))
    config = tmp_path / "other.toml"
    config.write_text(f"[arm_accuracy]\nposition_sd_mm = {other.arm_accuracy.position_sd_mm}\n")
    result = replayed("--config", str(config))
    assert result.exit_code == 3
    assert _lines(result)[0].startswith("settings sha256: recorded ")
    assert any("the settings are not in the record" in line for line in _lines(result))


@pytest.mark.parametrize("arguments", [[], ["unknown"], ["unknown", "--all"], ["--all", "--workers", "0"]])
def test_wrong_usage_is_status_2(replayed, arguments) -> None:
    assert replayed(*arguments, case=False).exit_code == 2


def test_numbers_are_equal_to_a_billionth_of_their_size() -> None:
    recorded = {"a": [1000.0, {"b": True}], "elapsed_ms": 1.0, "n": None}
    assert differences("x", recorded, {"a": [1000.0 + 9e-7, {"b": True}], "elapsed_ms": 2.0}) == []
    found = differences("x", recorded, {"a": [1000.0 + 2e-6, {"b": 1}], "c": 1})
    assert [one.field for one in found] == ["a[0]", "a[1].b", "c"]
    assert differences("x", [1.0], [1.0, 2.0])[0].field == ""
    assert differences("x", "nan", float("nan")) == []  # as the record says what JSON cannot


@pytest.fixture
def archive(make_site, tmp_path) -> Path:
    return make_site(tmp_path / "archive", State.CLOSED, State.ABORTED).folder


def test_a_whole_archive_is_replayed_by_several_processes(archive) -> None:
    result = CliRunner().invoke(audit, ["replay", "--all", "--workers", "2", "--data-folder", str(archive)])
    assert result.exit_code == 0, result.output
    assert f"2 cases, {2 * _RESULTS} results" in result.stdout


def test_a_whole_archive_is_replayed_by_a_cluster(archive) -> None:
    from distributed import LocalCluster

    with LocalCluster(n_workers=1, threads_per_worker=1, processes=True, dashboard_address="127.0.0.1:0") as cluster:
        address = cluster.scheduler_address
        result = CliRunner().invoke(audit, ["replay", "--all", "--scheduler", address, "--data-folder", str(archive)])
    assert result.exit_code == 0, result.output
    assert f"2 cases, {2 * _RESULTS} results" in result.stdout


def test_a_cluster_that_is_not_there_is_said_in_one_line(replayed, monkeypatch) -> None:
    monkeypatch.setattr(crews, "_CONNECT_S", 0.5)
    result = replayed("--scheduler", "tcp://127.0.0.1:1")
    assert result.exit_code == 2
    assert "no scheduler answers" in result.stderr
    monkeypatch.setitem(sys.modules, "distributed", None)
    result = replayed("--scheduler", "tcp://127.0.0.1:1")
    assert result.exit_code == 2
    assert "pip install 'coaxial[cluster]'" in result.stderr


def _input(case_id: str) -> CaseInput:
    return CaseInput(case_id, "0", None, {}, {}, (), ())


def test_cases_are_read_only_a_little_ahead_of_the_workers() -> None:
    read = 0

    def cases() -> Iterator[CaseInput]:
        nonlocal read
        for number in range(100):
            read += 1
            yield _input(str(number))

    with on_this_machine(2) as crew:
        replays: Iterator[CaseReplay] = crew(cases())
        next(replays)
        assert read <= 6
        assert len(list(replays)) == 99

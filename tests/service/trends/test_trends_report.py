"""`coaxial trends` and GET /api/trends on a record: what is read of a case, what is flagged, what is never told."""

import json

import numpy as np
import pytest
from typer.testing import CliRunner, Result

from service.auth.permissions import Role
from service.cli.trends import trends as command
from service.devices.store import DeviceKind
from service.errors import ErrorCode, ServiceError
from service.trends.figures import CaseFigures, Measure, finished_cases
from service.trends.series import chart_trends
from tests.service.trends.conftest import NAME, PATIENT

_STEADY = np.abs(0.03 + 0.01 * np.sin(np.arange(20) * 2.4))


@pytest.fixture
def trends(database, tmp_path, monkeypatch):
    def run(*more: str) -> Result:
        address = database.writer.url.render_as_string(hide_password=False)
        monkeypatch.setenv("COAXIAL_DATABASE_URL", address)
        monkeypatch.setenv("COAXIAL_MIN_FREE_BYTES", "0")
        return CliRunner().invoke(command, ["--data-folder", str(tmp_path / "data"), *more])

    return run


def test_a_case_is_read_by_its_first_verification_and_without_devices_that_changed(database, record_cases) -> None:
    record_cases([0.5, 0.25])
    with database.read() as connection:
        first, second = finished_cases(connection)
    assert second.values[Measure.POSITION_ERROR] == 0.25
    assert second.values[Measure.ANGLE_ERROR] == 0.02
    assert second.values[Measure.RESIDUAL] == 0.1
    assert second.values[Measure.DISTORTION] == pytest.approx(5.0)  # every pixel shifted by (3, 4)
    assert second.values[Measure.EXPOSURES] == 3.0
    assert second.values[Measure.TIME] < 1.0
    assert set(second.devices) == {DeviceKind.GUIDE, DeviceKind.CARM, DeviceKind.TCP}
    assert set(first.devices) == {DeviceKind.GUIDE, DeviceKind.CARM}


def test_a_drift_is_told_by_device_and_nobody_is_named(trends, record_cases, tmp_path) -> None:
    record_cases(_STEADY + 0.02 * np.arange(20))
    table = trends("--out", str(tmp_path / "plots"))
    assert table.exit_code == 0, table.output
    printed = trends("--json")
    assert printed.exit_code == 0, printed.output
    answer = json.loads(printed.stdout)
    drifting = [one for one in answer["series"] if one["charts"]["rising"]["signal"]]
    assert {(one["measure"], one["device_kind"]) for one in drifting} == {
        ("position_error_mm", "guide"), ("position_error_mm", "carm"), ("position_error_mm", "tcp")
    }  # fmt: skip
    assert drifting[0]["charts"]["rising"]["signal"]["per_case"] == pytest.approx(0.02, rel=0.1)
    assert answer["drifting"] == 3
    assert sorted(file.name for file in (tmp_path / "plots").iterdir()) == [
        "trends-1-guide.png", "trends-2-carm.png", "trends-3-tcp.png"
    ]  # fmt: skip
    for word in (PATIENT, NAME, "1.2.3"):
        assert word not in printed.stdout + table.stdout


def test_too_few_cases_are_refused_with_their_number(trends, record_cases) -> None:
    record_cases(_STEADY[:7])
    refused = trends()
    assert refused.exit_code == 3
    assert "too_few_cases" in refused.stderr
    assert "Wait for more cases" in refused.stderr


def test_an_empty_record_is_refused_as_well(trends) -> None:
    assert trends("--json").exit_code == 3


def test_cases_are_charted_by_device_and_the_newest_hundred_count() -> None:
    cases = [_figures(number, "old" if number < 7 else "new") for number in range(120)]
    trends = chart_trends(cases)
    assert {one.device for one in trends.series} == {"new"}
    assert [case.case_id for case in trends.series[0].cases] == [str(number) for number in range(20, 120)]
    with pytest.raises(ServiceError) as caught:
        chart_trends(cases[:14])
    assert (caught.value.code, caught.value.measured, caught.value.limit) == (ErrorCode.TOO_FEW_CASES, 7, 8)


def test_charts_of_the_same_cases_share_one_chance_of_a_false_alarm() -> None:
    together = [_figures(number, "d") for number in range(20)]
    apart = [_figures(number, "one" if number % 2 else "other") for number in range(20)]
    limits = [chart_trends(cases).series[0].charts[0].limit for cases in (together, apart)]
    assert limits[0] < limits[1]


def _figures(number: int, device: str) -> CaseFigures:
    return CaseFigures(str(number), "", {Measure.RESIDUAL: 0.1 + number % 3}, dict.fromkeys(DeviceKind, device))


@pytest.mark.parametrize("role", [Role.ENGINEER, Role.SURGEON, Role.AUDITOR])
def test_over_http_a_record_without_cases_is_a_typed_refusal(running, role: Role) -> None:
    with running.client(role) as client:
        answer = client.get("/trends")
    assert (answer.status_code, answer.json()["code"], answer.json()["limit"]) == (409, "too_few_cases", 8)

"""Liveness, readiness and metrics of a running service."""

import asyncio
import socket
import subprocess
import sys
from types import SimpleNamespace

import httpx
import pytest

from service.auth.permissions import Role
from service.errors import ErrorCode, ServiceError
from service.operations import counts, health
from service.operations.metrics import measuring
from service.settings import DicomSettings, HttpSettings, MetricsSettings, Settings
from service.vision_jobs import JOBS

_CASE = {
    "patient_id": "P-secret",
    "study_uid": "1.2.3",
    "targets": [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}],
}


def test_a_service_lives_and_a_room_without_an_arm_is_ready_without_one(running):
    with running.client(None) as stranger:
        assert stranger.get("/health/live").json()["status"] == "up"
        assert stranger.get("/health/ready").json()["status"] == "ready"


def test_whoever_looks_for_health_below_no_prefix_finds_it_too(running):
    with running.client(None) as stranger:
        for path, status in (("/health/live", "up"), ("/health/ready", "ready")):
            assert stranger.get(stranger.base_url.copy_with(path=path)).json()["status"] == status


def test_a_full_disk_and_a_lost_database_are_named_as_reasons(running, monkeypatch):
    def full(*_):
        raise OSError

    monkeypatch.setattr(health, "check_free_space", full)
    monkeypatch.setattr(health, "_ask_database", _busy)
    with running.client(None) as stranger:
        answer = stranger.get("/health/ready")
        assert stranger.get("/health/live").status_code == 200
    assert (answer.status_code, answer.json()["code"]) == (503, "not_ready")
    assert answer.json()["measured"] == "database_busy, disk_full"


def _busy(_):
    raise ServiceError(ErrorCode.DATABASE_BUSY, "another writer")


@pytest.mark.parametrize(
    ("age_s", "status", "reasons"),
    [
        (None, None, ["guard_down"]),
        (2.6, SimpleNamespace(connected=True), ["guard_down"]),
        (0.1, SimpleNamespace(connected=False), ["arm_unreachable"]),
        (0.1, SimpleNamespace(connected=True), []),
    ],
)
def test_a_room_with_an_arm_is_ready_once_its_guard_hears_it(age_s, status, reasons):
    settings = Settings(arm_address="203.0.113.1")
    bridge = SimpleNamespace(guard_age_s=age_s, status=status)
    assert health._arm(SimpleNamespace(parts=SimpleNamespace(settings=settings), bridge=bridge)) == reasons


@pytest.fixture(scope="module")
def measured(serving, tmp_path_factory, databases):
    """A service that serves its metrics, and their address."""
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    folder = tmp_path_factory.mktemp("measured")
    with databases.empty(folder) as address:
        settings = Settings(
            data_folder=folder,
            database_url=address,
            min_free_bytes=0,
            http=HttpSettings(port=0),
            dicom=DicomSettings(port=0),
            metrics=MetricsSettings(port=port),
        )
        with serving(settings) as service:
            yield service, f"http://127.0.0.1:{port}/metrics"


def _sample(text: str, name: str) -> float:
    return next(float(line.split()[-1]) for line in text.splitlines() if line.startswith(f"{name} "))


def test_metrics_tell_the_state_the_decisions_and_each_verdict_and_no_patient(measured, device_files):
    service, address = measured
    with service.client(Role.SURGEON) as surgeon:
        for kind, content in device_files.items():
            surgeon.post(f"/devices/{kind}", content=content.encode())
        case_id = surgeon.post("/cases", json=_CASE, headers={"Idempotency-Key": "k"}).json()["id"]
        headers = {"If-Match": '"1"', "Idempotency-Key": "l"}
        refused = surgeon.post(f"/cases/{case_id}/carm-position-confirmed", json={}, headers=headers)
        assert refused.json()["code"] == "interlock", refused.text
    text = httpx.get(address).text
    assert _sample(text, 'coaxial_case_state{state="case_open"}') == 1.0
    assert _sample(text, 'coaxial_case_state{state="moving"}') == 0.0
    assert _sample(text, 'coaxial_decisions_total{answer="interlock",trigger="carm_position_confirmed"}') >= 1.0
    assert _sample(text, 'coaxial_verdicts_total{hazard="H04",interlock="at_rest",verdict="refused"}') >= 1.0
    assert _sample(text, "coaxial_undelivered_objects") == 0.0
    assert _sample(text, "coaxial_free_bytes") > 0.0
    assert "P-secret" not in text
    assert case_id not in text


def test_what_an_alarm_may_ask_for_is_zero_before_it_happens():
    """Prometheus sees no increase in a series whose first value is already one."""
    # in a process of its own: in this one, jobs may have ended already
    tell = "import service.operations.counts, prometheus_client as p; print(p.generate_latest().decode())"
    text = subprocess.run([sys.executable, "-c", tell], capture_output=True, text=True, check=True, timeout=60).stdout
    for job in JOBS:
        assert _sample(text, f'coaxial_image_work_failures_total{{job="{job}"}}') == 0.0
        assert _sample(text, f'coaxial_image_work_seconds_count{{job="{job}"}}') == 0.0
    assert _sample(text, 'coaxial_verdicts_total{hazard="H13",interlock="permit_fresh",verdict="refused"}') == 0.0


def test_a_stop_and_a_job_are_timed_and_a_failed_job_is_only_counted():
    def sums() -> tuple[float, float, float]:
        stops, jobs = counts._STOPS, counts._JOBS.labels("test")
        return stops._sum.get(), jobs._sum.get(), counts._FAILED_JOBS.labels("test")._value.get()

    before = sums()
    counts.count_stop(0.004)
    counts.count_image_work("test", 0.25, failed=False)
    counts.count_image_work("test", 20.0, failed=True)
    assert [now - then for now, then in zip(sums(), before, strict=True)] == pytest.approx([0.004, 0.25, 1.0])


def test_nothing_listens_for_prometheus_unless_a_port_is_named(running):
    assert running.parts.settings.metrics.port is None


def test_a_taken_metrics_port_is_refused_in_words():
    async def start(port: int) -> None:
        parts = SimpleNamespace(settings=Settings(metrics=MetricsSettings(port=port)))
        async with measuring(None, parts):
            raise AssertionError("two listen on one port")

    with socket.create_server(("127.0.0.1", 0)) as taken, pytest.raises(ServiceError, match="cannot serve metrics"):
        asyncio.run(start(taken.getsockname()[1]))

"""The log of a served process: every line a JSON object, whoever says it, and no word that may quote a patient."""

import json
import subprocess
import sys

import pytest

from service.settings import VisionSettings
from service.vision_worker import VisionWorker

_CONFIGURED = "import logging, threading, warnings\nfrom service.structured_log import configure_log\nconfigure_log()\n"
_PATIENT = "Doe^Jane"
_FAILING = f"""
def fail():
    try: raise ValueError("no number: {_PATIENT}")
    except ValueError as error: raise RuntimeError("{_PATIENT}") from error
"""


def _logged(code: str) -> list[dict]:
    ended = subprocess.run([sys.executable, "-c", _CONFIGURED + code], capture_output=True, text=True, timeout=60)
    assert _PATIENT not in ended.stderr
    return [json.loads(line) for line in ended.stderr.splitlines()]


def test_the_web_servers_and_the_migrations_words_are_quoted():
    (web, schema) = _logged(
        "logging.getLogger('uvicorn.error').error('address %s\\n', 'in use')\n"
        "logging.getLogger('alembic.runtime').warning('one branch')"
    )
    assert (web["event"], web["logger"], web["level"], web["said"]) == (
        "library_said",
        "uvicorn.error",
        "error",
        "address in use",
    )
    assert web["timestamp"] < schema["timestamp"]
    assert schema["said"] == "one branch"


@pytest.mark.hazard("H27")
@pytest.mark.parametrize("library", ["pynetdicom.acse", "pydicom", "asyncio", "sqlalchemy.pool", "any"])
def test_of_every_other_library_only_where_it_said_something(library):
    failing = f"try: fail()\nexcept RuntimeError as error: log.exception(error)\nlog.warning('%s', '{_PATIENT}')"
    failed, warned = _logged(f"{_FAILING}\nlog = logging.getLogger({library!r})\nlog.info('nothing')\n{failing}")
    assert (failed["logger"], failed["level"]) == (library, "error")
    assert [cause.split(" < ")[0] for cause in failed["exception"]] == ["RuntimeError", "ValueError"]
    assert "<string>:" in failed["exception"][0]
    assert warned["where"].startswith("<string>:")
    assert "said" not in warned


@pytest.mark.hazard("H27")
@pytest.mark.parametrize(
    ("how", "event"),
    [
        (f"warnings.warn('{_PATIENT}')", "python_warning"),
        ("fail()", "uncaught"),
        ("one = threading.Thread(target=fail); one.start(); one.join()", "uncaught"),
        ("class Held:\n    def __del__(self): fail()\nHeld()", "uncaught"),
        ("import structlog\ntry: fail()\nexcept RuntimeError: structlog.get_logger().exception('failed')", "failed"),
    ],
)
def test_what_nobody_caught_is_a_line_of_the_log(how, event):
    (line,) = _logged(_FAILING + how)
    assert line["event"] == event
    assert line["level"] in ("warning", "error", "critical")


@pytest.mark.hazard("H27")
def test_a_header_that_pydicom_dislikes_is_not_quoted():
    lines = _logged(
        "import pydicom\nfrom pydicom.dataelem import DataElement\n"
        f"DataElement('PatientBirthDate', 'DA', '{_PATIENT}', validation_mode=pydicom.config.WARN)"
    )
    assert {line["event"] for line in lines} == {"python_warning", "library_said"}


def test_an_event_of_the_service_has_its_time_level_and_ids():
    (line,) = _logged("import structlog\nstructlog.get_logger().info('served', port=8443)")
    assert (line["event"], line["level"], line["port"]) == ("served", "info", 8443)
    assert "timestamp" in line


@pytest.mark.hazard("H27")
def test_the_image_worker_logs_in_the_same_form(tmp_path, monkeypatch, capfd):
    jobs = f"import warnings\ndef warn(): warnings.warn('{_PATIENT}'); return {{}}\nJOBS = {{'warn': warn}}\n"
    (tmp_path / "warning_jobs.py").write_text(jobs)
    monkeypatch.syspath_prepend(tmp_path)
    worker = VisionWorker(VisionSettings(), "warning_jobs")
    try:
        worker._timed("warn", ())
    finally:
        worker._end()
    (line,) = capfd.readouterr().err.splitlines()
    assert json.loads(line)["event"] == "python_warning"

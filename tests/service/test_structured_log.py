"""What a served process writes to stderr is one JSON object a line, whoever wrote it, and names no patient."""

import json
import subprocess
import sys
from typing import Any

_WRITE = """
import logging, warnings
import pydicom, structlog
from pydicom.dataelem import DataElement
from service.structured_log import configure_log
configure_log()
structlog.get_logger().info("served", port=8443)
logging.getLogger("uvicorn.error").info("not told")
logging.getLogger("pynetdicom.assoc").warning("Association from %s", "CARM", extra={"patient": "DOE^JANE"})
try:
    raise ValueError("bad value 'DOE^JANE'")
except ValueError:
    logging.getLogger("uvicorn.error").exception("Exception in ASGI application\\n")
warnings.warn("an old function")
DataElement("PatientBirthDate", "DA", "DOE^JANE", validation_mode=pydicom.config.WARN)
"""


def written() -> tuple[str, list[dict[str, Any]]]:
    """Of a process of its own: a log is configured once."""
    told = subprocess.run([sys.executable, "-c", _WRITE], capture_output=True, text=True, timeout=60, check=True)
    return told.stderr, [json.loads(line) for line in told.stderr.splitlines()]


def test_every_line_is_an_object_with_its_time_and_level() -> None:
    _, lines = written()
    assert [line["event"].split(":")[0].strip() for line in lines][:3] == [
        "served",
        "Association from CARM",
        "Exception in ASGI application",
    ]
    assert len(lines) == 4  # and the warning
    assert all({"timestamp", "level", "event"} <= line.keys() for line in lines)
    assert [line.get("logger") for line in lines[1:]] == ["pynetdicom.assoc", "uvicorn.error", "py.warnings"]


def test_a_librarys_exception_is_told_by_kind_and_place_alone() -> None:
    text, lines = written()
    assert "DOE" not in text.replace(lines[2]["exception"], "")
    assert lines[2]["exception"].endswith("ValueError")
    assert 'File "<string>", line' in lines[2]["exception"]

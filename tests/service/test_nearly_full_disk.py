"""A disk that is nearly full: no motion begins on it, and what a person states is tried all the same (H24)."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from service.conductor.caller import Caller
from service.conductor.conductor import Conductor
from service.database.engines import Database
from service.errors import ErrorCode, ServiceError
from service.motion.bridge import ArmBridge
from service.settings import Settings
from workflow.triggers import Trigger


@pytest.mark.hazard("H24")
@pytest.mark.parametrize(
    ("trigger", "code"), [(Trigger.MOVE_STARTED, ErrorCode.DISK_FULL), (Trigger.SLEEVE_IN, ErrorCode.CASE_UNKNOWN)]
)
def test_a_motion_needs_free_space_and_a_fact_does_not(database: Database, tmp_path: Path, trigger, code) -> None:
    """Neither comes with the version of a case: the one by the held button, the other since it is never refused."""
    parts: Any = SimpleNamespace(settings=Settings(data_folder=tmp_path, min_free_bytes=2**62), database=database)
    somebody: Any = SimpleNamespace(user_id=None)
    with pytest.raises(ServiceError) as caught:
        Conductor(parts, ArmBridge(None)).perform(Caller(somebody, "case", None, None, 1), trigger, lambda _: None)
    assert caught.value.code == code

"""What the documentation shows as code or as a file is what the program takes."""

import ast
import json
import re
from dataclasses import fields
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import MagicMock

import numpy as np
from sybil import Document
from sybil.parsers.markdown import CodeBlockParser

from coaxial_client import Case, Coaxial, Hold
from robot.tool import read_tool
from service.cases.records import StoredEvent
from service.cases.server_sent import server_sent
from service.motion.endings import Ending
from service.motion.hold import HeartbeatMessage, _progress
from service.settings import load_settings
from simulator.door import create_door
from tests.service.conftest import PASSWORD
from vision.devices import read_guide

_ROOT = Path(__file__).parents[2]
_DEVICES = {
    "guide": _ROOT / "tests" / "devices" / "guide.toml",
    "carm": _ROOT / "tests" / "devices" / "flat-panel.toml",
    "tcp": _ROOT / "tests" / "devices" / "tcp.toml",
    "room": _ROOT / "tests" / "devices" / "room.toml",
}


def _blocks(page: str, language: str) -> list[str]:
    """The page's fenced blocks of one language, in their order."""
    document = Document.parse(str(_ROOT / "docs" / page), CodeBlockParser(language, lambda _: None))
    return [str(example.parsed) for example in document.examples()]


def test_the_tutorial_calls_what_the_room_s_door_has():
    door = create_door(*2 * (MagicMock(spec_set=["patient", "controller"]),))
    paths = {re.compile(re.sub(r"{\w+}", "[^/]+", path)): item for path, item in door.openapi()["paths"].items()}
    called = re.findall(r"(?:(GET|POST|DELETE) |curl )ROOM(/[\w/-]+)(.*)", (_ROOT / "docs" / "tutorial.md").read_text())
    assert len(called) >= 10
    for method, path, rest in called:
        wanted = (method or ("POST" if "--json" in rest else "GET")).lower()
        assert any(one.fullmatch(path) and wanted in item for one, item in paths.items()), path


def test_the_settings_file_of_the_engineers_manual_is_one(tmp_path):
    file = tmp_path / "coaxial.toml"
    file.write_text(_blocks("engineers-manual.md", "toml")[0])
    settings = load_settings(file)
    assert settings.dicom.accepted_callers == ("CARM",)
    assert settings.audit.anchor_file is not None


def test_the_guide_file_of_the_engineers_manual_is_one():
    guide = read_guide(_blocks("engineers-manual.md", "toml")[1].encode())
    assert guide.name == "guide-7"
    assert guide.bead is not None


def test_the_tcp_file_of_the_engineers_manual_is_one() -> None:
    tool = read_tool(_blocks("engineers-manual.md", "toml")[2].encode())
    assert tool.calibration_sd_mm == 1.0
    assert tool.expires is not None


def test_the_program_of_the_api_guide_runs_and_prints_what_the_page_says(running):
    with Coaxial(running.url) as engineer:
        engineer.sign_in("engineer", PASSWORD)
        for kind, file in _DEVICES.items():
            engineer.upload_device(kind, file.read_bytes())
    program, _ = _blocks("api.md", "python")
    printed: list[str] = []
    given = {
        "url": running.url,
        "password": PASSWORD,
        "print": lambda *words: printed.append(" ".join(map(str, words))),
    }
    exec(compile(program, "docs/api.md", "exec"), given)
    assert printed == _blocks("api.md", "text")[0].splitlines()


def test_the_messages_of_the_api_guide_have_the_fields_that_are_sent():
    event, progress, heartbeat, ended = map(json.loads, _blocks("api.md", "json"))
    HeartbeatMessage.model_validate(heartbeat)
    status = SimpleNamespace(challenge="", phase="idle", held=False, arm=None)
    assert progress.keys() == _progress(status, np.eye(4)).keys()
    assert ended.keys() == {"type"} | {field.name for field in fields(Ending)}
    stored = StoredEvent(*[event.get(field.name, 0) for field in fields(StoredEvent)])
    (said,) = re.findall(r"^data: (.*)$", server_sent(stored).text.decode(), re.MULTILINE)
    assert event.keys() == json.loads(said).keys()


def test_what_the_api_guide_calls_to_move_an_arm_is_there():
    _, motion = _blocks("api.md", "python")
    called = {
        node.func.attr
        for node in ast.walk(ast.parse(motion))
        if isinstance(node, ast.Call) and hasattr(node.func, "attr")
    }
    assert called == {"plan", "hold", "approve", "wait"}
    assert all(hasattr(Case, name) for name in called - {"wait"})
    assert hasattr(Hold, "wait")

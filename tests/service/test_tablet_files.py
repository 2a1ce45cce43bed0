"""The tablet's files: whole, in every language, and unable to ask anybody but the service for anything."""

import json
import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from hatchling.builders.wheel import WheelBuilder

from robot.envelope import links
from service.web.assets import assets, assets_in
from service.web.router import POLICY
from workflow.interlocks import INTERLOCKS
from workflow.states import GuideState, State
from workflow.triggers import Trigger

_TREE = Path(__file__).parents[2]
_CLIENT = _TREE / "service" / "web" / "client"
_ERROR_CODES = _TREE / "docs" / "error-codes.md"
_WORDS = {path.stem: json.loads(path.read_text()) for path in (_CLIENT / "locales").glob("*.json")}
_SOURCES = {path: path.read_text() for path in (_CLIENT / "js").rglob("*.js")}


def test_the_page_comes_with_its_policy_and_is_not_sent_twice(running):
    with running.client(None) as client:
        page = client.get(f"{running.url}/")
        again = client.get(f"{running.url}/", headers={"If-None-Match": page.headers["etag"]})
    assert page.status_code == 200
    assert page.headers["content-security-policy"] == POLICY
    assert "unsafe" not in POLICY
    assert page.headers["cache-control"] == "no-cache"
    assert (again.status_code, again.content) == (304, b"")


def test_every_file_is_served_under_its_own_type(running):
    with running.client(None) as client:
        for address, asset in assets().items():
            answer = client.get(f"{running.url}{address}")
            assert (answer.status_code, answer.content) == (200, asset.content), address
            assert answer.headers["content-type"] == asset.media_type
            assert answer.headers["x-content-type-options"] == "nosniff"


@pytest.mark.parametrize(
    "address", ["/js/", "/js/none.js", "/../settings.py", "/%2e%2e/settings.py", "/js/..%2f..%2frouter.py"]
)
def test_no_other_file_can_be_asked_for(running, address):
    with running.client(None) as client:
        assert client.get(f"{running.url}{address}").status_code == 404


def test_what_the_files_name_is_there_and_is_the_service_s_own():
    known = assets()
    for path in _CLIENT.rglob("*"):
        if path.suffix not in (".js", ".css", ".html") or path.parent.name == "vendor":
            continue
        text = path.read_text()
        assert not re.search(r"(https?|wss?)://(?!\$)", text), path
        for name in re.findall(r'(?:from "|import "|src="|href="|url\(")([^"]+)"', text):
            target = name if name.startswith("/") else "/" + str((path.parent / name).resolve().relative_to(_CLIENT))
            assert target in known, f"{path} names {name}"


def test_icons_come_with_their_style_sheet():
    written = (_CLIENT / "css" / "icons.css").read_text()
    served = assets()["/css/icons.css"].content.decode()
    assert served.count("data:image/svg+xml;base64,") == written.count("/icons/") > 20
    assert "/icons/" not in served


def test_an_installed_program_has_every_file():
    packed = {file.distribution_path for file in WheelBuilder(str(_TREE)).recurse_included_files()}
    assert {path.relative_to(_TREE).as_posix() for path in _CLIENT.rglob("*") if path.is_file()} <= packed


def test_one_more_file_adds_a_language(tmp_path):
    folder = tmp_path / "client"
    shutil.copytree(_CLIENT, folder)
    (folder / "locales" / "fr.json").write_text(json.dumps({"language.name": "Français"}))
    languages = json.loads(assets_in(folder)["/locales.json"].content)
    assert languages == {"de": "Deutsch", "en": "English", "fr": "Français"}


@pytest.mark.parametrize("language", sorted(_WORDS.keys() - {"en"}))
def test_every_language_has_the_words_of_english(language):
    told_by_service = {key for key in _WORDS[language] if _is_told_by_service(key)}
    assert _WORDS[language].keys() - told_by_service == {key for key in _WORDS["en"] if not _is_told_by_service(key)}


def test_the_same_places_are_filled_in_every_language():
    for key in _WORDS["en"]:
        places = [sorted(re.findall(r"\{\w+\}", words[key])) for words in _WORDS.values() if key in words]
        assert places.count(places[0]) == len(places), key


def test_every_word_that_a_screen_names_is_there():
    for path, text in _SOURCES.items():
        for key in re.findall(r'\bt\("([a-z_.]+)"', text):
            assert key in _WORDS["en"], f"{path}: {key}"


@pytest.mark.parametrize(
    ("beginning", "endings"),
    [
        ("state", State),
        ("do_now", State),
        ("guide", GuideState),
        ("trigger", Trigger),
    ],
)
def test_every_word_for_a_state_or_a_trigger_is_there(beginning, endings):
    assert {f"{beginning}.{one}" for one in endings} <= _WORDS["en"].keys()


@pytest.mark.parametrize("language", sorted(_WORDS.keys() - {"en"}))
def test_every_refusal_has_its_words_where_the_service_s_english_is_not_spoken(language):
    """Of an interlock the status says what leads onwards; a refused request says itself what to do."""
    codes = re.findall(r"^\| `(\w+)` \|", _ERROR_CODES.read_text(), re.MULTILINE)
    assert len(codes) > 100
    told = {f"code.{code}" for code in (*INTERLOCKS, *codes)} | {f"do.{code}" for code in codes}
    assert told - _WORDS[language].keys() == set()


def test_every_part_of_the_arm_has_a_name_in_every_language():
    parts = ("guide", "holder", *links(np.tile(np.eye(4), (7, 1, 1))).names)
    for words in _WORDS.values():
        assert {f"part.{part.replace(' ', '_')}" for part in parts} <= words.keys()


def _is_told_by_service(key: str) -> bool:
    """English is what the service itself speaks."""
    return key.startswith(("code.", "do."))

"""The tablet's files: whole, in two languages, and unable to ask anybody but the service for anything."""

import json
import re
from pathlib import Path

import pytest

from service.web.assets import assets
from service.web.router import POLICY
from workflow.interlocks import INTERLOCKS
from workflow.refusals import RefusalCode
from workflow.states import GuideState, State
from workflow.triggers import Trigger

_CLIENT = Path(__file__).parents[2] / "service" / "web" / "client"
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


def test_every_language_has_the_same_words():
    names = {language: {key for key in words if not _is_told_by_service(key)} for language, words in _WORDS.items()}
    assert set(names) == {"en", "de"}
    assert names["en"] == names["de"]


def test_the_same_places_are_filled_in_every_language():
    for key in _WORDS["en"].keys() & _WORDS["de"].keys():
        places = [set(re.findall(r"\{\w+\}", words[key])) for words in _WORDS.values()]
        assert places[0] == places[1], key


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


def test_every_refusal_of_the_rules_is_told_in_german():
    """What the service adds of its own and the file has not yet is told in the service's English."""
    assert {f"code.{code}" for code in (*INTERLOCKS, *RefusalCode)} <= _WORDS["de"].keys()


def _is_told_by_service(key: str) -> bool:
    """English is what the service itself speaks."""
    return key.startswith(("code.", "do."))

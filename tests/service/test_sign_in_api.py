"""Signing in over HTTP, cookies and other sites, locked sessions."""

import pytest

from service.auth.dependencies import COOKIE
from service.auth.permissions import Role
from service.settings import DicomSettings, HttpSettings, SessionSettings, Settings

_PASSWORD, _PIN = "correct horse", "2468"


def _code(response) -> str:
    assert response.headers["content-type"] == "application/problem+json"
    return response.json()["code"]


@pytest.fixture
def browser(running):
    """A client that signed in and keeps only the cookie, as a page does."""
    with running.client(None) as client:
        response = client.post("/session", json={"name": "surgeon", "password": _PASSWORD})
        assert response.status_code == 201
        yield client


def test_nobody_is_signed_in_without_a_token(running):
    with running.client(None) as client:
        for response in (client.get("/session"), client.get("/status"), client.get("/cases")):
            assert response.status_code == 401
            assert _code(response) == "not_signed_in"


@pytest.mark.hazard("H27")
def test_a_made_up_token_is_nobody(running):
    with running.client(None) as client:
        response = client.get("/session", headers={"Authorization": "Bearer " + "x" * 43})
    assert _code(response) == "not_signed_in"


def test_the_token_works_as_bearer_and_as_cookie(running, browser):
    with running.client(Role.SURGEON) as client:
        assert client.get("/session").json()["user"] == "surgeon"
    assert browser.get("/session").json()["role"] == "surgeon"


def test_the_cookie_is_out_of_reach_of_scripts_and_other_sites(running):
    with running.client(None) as client:
        cookie = client.post("/session", json={"name": "auditor", "password": _PASSWORD}).headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "samesite=strict" in cookie.lower()


def test_a_wrong_password_and_an_unknown_name_answer_alike(running):
    with running.client(None) as client:
        wrong = client.post("/session", json={"name": "engineer", "password": "wrong"})
        unknown = client.post("/session", json={"name": "nobody", "password": "wrong"})
    assert wrong.status_code == unknown.status_code == 401
    assert wrong.json() == unknown.json()


@pytest.mark.hazard("H27")
@pytest.mark.parametrize("origin", ["https://evil.example", "null", "http://127.0.0.1:1", "http://[::1"])
def test_what_another_sites_page_posts_is_refused(browser, origin):
    response = browser.post("/session/lock", headers={"Origin": origin})
    assert response.status_code == 403
    assert _code(response) == "origin_refused"
    assert browser.get("/session").json()["status"] == "active"


@pytest.mark.hazard("H27")
def test_another_site_cannot_sign_a_browser_in(running):
    with running.client(None) as client:
        credentials = {"name": "surgeon", "password": _PASSWORD}
        response = client.post("/session", json=credentials, headers={"Origin": "https://evil.example"})
    assert _code(response) == "origin_refused"


def test_the_services_own_page_may_post(running, browser):
    assert browser.post("/session/lock", headers={"Origin": running.url}).status_code == 200
    assert browser.post("/session/unlock", json={"pin": _PIN}, headers={"Origin": running.url}).status_code == 200


def test_a_locked_session_can_only_be_unlocked_with_its_pin(browser):
    assert browser.post("/session/lock").json()["status"] == "locked"
    assert _code(browser.get("/cases")) == "session_locked"
    assert _code(browser.post("/session/unlock", json={"pin": "0000"})) == "pin_refused"
    assert browser.post("/session/unlock", json={"pin": _PIN}).json()["status"] == "active"
    assert browser.get("/cases").status_code == 200


@pytest.mark.hazard("H27")
def test_after_signing_out_the_token_is_worth_nothing(running):
    with running.client(None) as client:
        token = client.post("/session", json={"name": "surgeon", "password": _PASSWORD}).json()["token"]
        assert client.delete("/session").status_code == 204
        client.cookies.clear()
        assert _code(client.get("/session", headers={"Authorization": f"Bearer {token}"})) == "not_signed_in"


@pytest.mark.hazard("H27")
def test_a_token_that_was_planted_before_signing_in_is_worth_nothing_after_it(running):
    planted, credentials = "x" * 43, {"name": "surgeon", "password": _PASSWORD}
    with running.client(None) as client:
        client.post("/session", json=credentials, headers={"Cookie": f"{COOKIE}={planted}"})
        assert client.cookies.get(COOKIE) not in (planted, None)
        assert client.get("/session").json()["user"] == "surgeon"
    with running.client(None) as attacker:
        assert _code(attacker.get("/session", headers={"Authorization": f"Bearer {planted}"})) == "not_signed_in"


def test_name_and_pin_sign_in_at_a_tablet(running):
    with running.client(None) as client:
        answer = client.post("/session", json={"name": "operator", "pin": _PIN})
        assert answer.status_code == 201
        assert client.get("/session").json()["role"] == "operator"


def test_a_wrong_pin_and_both_proofs_at_once_are_refused(running):
    with running.client(None) as client:
        assert _code(client.post("/session", json={"name": "auditor", "pin": "9999"})) == "sign_in_refused"
        both = {"name": "auditor", "pin": _PIN, "password": _PASSWORD}
        assert _code(client.post("/session", json=both)) == "malformed_request"
        assert _code(client.post("/session", json={"name": "auditor"})) == "malformed_request"


def test_a_site_may_ask_for_the_password_at_tablets_too(serving, tmp_path):
    settings = Settings(
        data_folder=tmp_path,
        min_free_bytes=0,
        http=HttpSettings(port=0),
        dicom=DicomSettings(port=0),
        session=SessionSettings(pin_sign_in=False),
    )
    with serving(settings) as service, service.client(None) as client:
        assert _code(client.post("/session", json={"name": "surgeon", "pin": _PIN})) == "sign_in_refused"

"""TLS as the engineer's manual sets it up: what a tablet and a script find behind nginx."""

import os
import signal
import ssl
from collections.abc import Iterator
from contextlib import contextmanager

import httpx
import pytest

from coaxial_client import Coaxial
from tests.system.proxy import Proxy, proxied
from tests.system.service_process import PASSWORD, PIN
from tests.system.walk import lift, lifting

pytestmark = pytest.mark.hazard("H31")


@pytest.fixture(scope="module")
def service(start_service, controller):
    """A service that is only reached through TLS."""
    return start_service(controller.address, COAXIAL_HTTP__SECURE_COOKIE="true")


@pytest.fixture
def proxy(service, certificate, tmp_path):
    with proxied(service.url, certificate, tmp_path) as proxy:
        yield proxy


@pytest.fixture
def surgeon(proxy):
    with Coaxial(proxy.url, ca_file=proxy.authority) as client:
        client.sign_in("surgeon", PASSWORD)
        yield client


@pytest.fixture
def case(surgeon, prepared_case):
    opened = prepared_case(surgeon)
    yield opened
    opened.command("case-aborted", reason="end of the test")


def _browser(proxy: Proxy) -> httpx.Client:
    context = ssl.create_default_context(cafile=proxy.authority)
    return httpx.Client(base_url=proxy.url, verify=context, headers={"Origin": proxy.url}, trust_env=False)


def test_the_session_s_cookie_stays_within_tls_and_every_answer_is_hardened(proxy) -> None:
    with _browser(proxy) as browser:
        signed_in = browser.post("/api/session", json={"name": "surgeon", "password": PASSWORD})
        assert {"Secure", "HttpOnly", "SameSite=strict"} <= set(signed_in.headers["set-cookie"].split("; "))
        assert browser.get("/api/session").json()["user"] == "surgeon"
        elsewhere = {"Origin": "https://elsewhere.example"}
        answers = [signed_in, browser.get("/"), browser.get("/nothing"), browser.post("/api/stop", headers=elsewhere)]
    assert [answer.status_code for answer in answers] == [201, 200, 404, 403]
    for answer in answers:
        assert answer.headers["strict-transport-security"].startswith("max-age=")
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert "frame-ancestors 'none'" in answer.headers["content-security-policy"]


@pytest.mark.filterwarnings("ignore:ssl.TLSVersion")
def test_nobody_is_served_without_tls_or_with_an_old_one(proxy) -> None:
    plain = httpx.get(f"http://localhost:{proxy.port}/api/health/live", trust_env=False)
    assert (plain.status_code, "plain HTTP request was sent to HTTPS port" in plain.text) == (400, True)
    old = ssl.create_default_context(cafile=proxy.authority)
    old.set_ciphers("DEFAULT:@SECLEVEL=0")
    old.minimum_version, old.maximum_version = ssl.TLSVersion.TLSv1, ssl.TLSVersion.TLSv1_1
    with pytest.raises(httpx.ConnectError, match=r"(?i)protocol"):
        httpx.get(f"{proxy.url}/api/health/live", verify=old, trust_env=False)


def test_the_ledger_notes_the_address_that_nginx_saw_not_what_a_tablet_says(proxy, service) -> None:
    context = ssl.create_default_context(cafile=proxy.authority)
    with httpx.Client(transport=httpx.HTTPTransport(context, local_address="127.0.0.9")) as tablet:
        body = {"name": "auditor", "password": PASSWORD}
        answer = tablet.post(f"{proxy.url}/api/session", json=body, headers={"X-Forwarded-For": "10.1.2.3"})
        assert answer.status_code == 201
    ledger = service.run("audit", "export").stdout
    assert ("127.0.0.9" in ledger, "10.1.2.3" in ledger) == (True, False)


@pytest.mark.hazard("H16")
def test_a_held_motion_arrives_and_a_proxy_that_freezes_stops_it(case, proxy, controller, until) -> None:
    with case.hold(case.approve(lift(case, 10.0), PIN)) as hold:
        assert hold.wait(30.0).cause == "arrived"
    with lifting(case, controller, 60.0):
        with _frozen(proxy.workers):
            until(lambda: not controller.state().moving, 2.0)
        assert case.wait_for("safe_hold")["held_for"] == "heartbeat_lost"


@contextmanager
def _frozen(process_ids: list[int]) -> Iterator[None]:
    assert process_ids
    for process_id in process_ids:
        os.kill(process_id, signal.SIGSTOP)
    try:
        yield
    finally:
        for process_id in process_ids:
            os.kill(process_id, signal.SIGCONT)

"""Bad requests over HTTP: each a typed problem, none a stack or an exception's text."""

import asyncio
import json
import socket
from contextlib import ExitStack
from urllib.parse import urlsplit

import httpx
import pytest
from fastapi import FastAPI

from service.auth.permissions import Role
from service.problem_json import add_problem_handlers

_CASE = {
    "patient_id": "P1",
    "study_uid": "1.2.3",
    "targets": [{"name": "L4 left", "entry_mm": [0, 0, 0], "target_mm": [0, 40, 0]}],
}


def _problem(response: httpx.Response) -> dict:
    assert response.headers["content-type"] == "application/problem+json"
    problem = response.json()
    assert problem["status"] == response.status_code
    assert problem["what_to_do"]
    assert problem["type"] == f"urn:coaxial:error:{problem['code']}"
    return problem


@pytest.mark.parametrize(
    ("method", "path", "status", "code"),
    [
        ("GET", "/nothing", 404, "unknown_path"),
        ("GET", "/../../etc/passwd", 404, "unknown_path"),
        ("PATCH", "/cases", 405, "method_not_allowed"),
        ("GET", "/cases/unknown", 404, "case_unknown"),
        ("GET", "/cases/unknown/audit", 404, "case_unknown"),
        ("GET", "/images/unknown", 404, "image_unknown"),
        ("GET", "/images/unknown/original", 404, "image_unknown"),
        ("GET", "/images/unknown/findings", 404, "image_unknown"),
        ("GET", "/devices/unknown/original", 404, "device_unknown"),
        ("POST", "/devices/laser", 422, "malformed_request"),
        ("GET", "/audit?after=-1", 422, "malformed_request"),
        ("GET", "/audit?after=99999999999999999999999999", 422, "malformed_request"),
        ("GET", "/audit/export?case=a%00", 422, "malformed_request"),
    ],
)
def test_an_address_that_leads_nowhere(running, method, path, status, code):
    with running.client() as client:
        problem = _problem(client.request(method, path))
    assert (problem["status"], problem["code"]) == (status, code)


def test_a_case_that_nobody_opened_is_a_typed_refusal_wherever_it_is_named(running):
    with running.client(Role.SURGEON) as client:
        paths = client.get("/openapi.json").json()["paths"]
        asked = [(path, method) for path, ways in paths.items() if "{case_id}" in path for method in ways]
        headers = {"Idempotency-Key": "k", "If-Match": '"1"', "Control-Token": "1"}
        for path, method in asked:
            body = {} if method == "post" else None
            answer = client.request(method, path.removeprefix("/api").format_map(_Any()), json=body, headers=headers)
            assert answer.status_code < 500, (method, path, answer.text)
            _problem(answer) if answer.is_error else None
    assert len(asked) > 30


class _Any(dict):
    def __missing__(self, _key: str) -> str:
        return "unknown"


@pytest.mark.hazard("H09")
@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"{",
        b"\xff\xfe",
        b"[]",
        b"null",
        b"{}",
        json.dumps(_CASE | {"surprise": 1}).encode(),
        json.dumps(_CASE | {"patient_id": ""}).encode(),
        json.dumps(_CASE | {"study_uid": "not a uid"}).encode(),
        json.dumps(_CASE | {"targets": []}).encode(),
        json.dumps(_CASE | {"targets": _CASE["targets"] * 2}).encode(),
        json.dumps(_CASE | {"targets": [{"name": "a", "entry_mm": [0, 0], "target_mm": [0, 40, 0]}]}).encode(),
        b'{"patient_id": "P", "study_uid": "1", "targets": '
        b'[{"name": "a", "entry_mm": [NaN, 0, 0], "target_mm": [0, 40, 0]}]}',
        b'{"patient_id": "P", "study_uid": "1", "targets": '
        b'[{"name": "a", "entry_mm": [0, 0, 0], "target_mm": [0, 1e308, 0]}]}',
        json.dumps(_CASE | {"targets": [{"name": "m", "entry_mm": [0, 0, 0], "target_mm": [0, 0.04, 0]}]}).encode(),
    ],
)
def test_a_body_that_is_no_case(running, body):
    headers = {"Content-Type": "application/json", "Idempotency-Key": "k"}
    with running.client() as client:
        problem = _problem(client.post("/cases", content=body, headers=headers))
        assert client.get("/cases").json() == []
    assert problem["code"] == "malformed_request"
    assert problem["fields"]


@pytest.mark.hazard("H31")
def test_json_nested_too_deeply_is_refused(running):
    with running.client() as client:
        response = client.post("/cases", content=b"[" * 100_000, headers={"Content-Type": "application/json"})
    assert _problem(response)["status"] == 400


def test_a_command_without_a_key_is_refused(running):
    with running.client() as client:
        assert _problem(client.post("/cases", json=_CASE))["code"] == "idempotency_key_missing"


@pytest.mark.hazard("H31")
def test_a_body_over_the_limit_is_refused_declared_or_not(running):
    def chunks():
        for _ in range(5):
            yield b"x" * 1_000_000

    with running.client() as client:
        declared = _problem(client.post("/devices/guide", content=b"x" * 5_000_000))
        counted = _problem(client.post("/devices/guide", content=chunks()))
        json_headers = {"Content-Type": "application/json"}  # a body that the framework reads, not the route
        parsed = _problem(client.post("/session", content=chunks(), headers=json_headers))
    assert declared["code"] == counted["code"] == parsed["code"] == "body_too_large"
    assert declared["limit"] == counted["limit"] == parsed["limit"] == 4_000_000


@pytest.mark.hazard("H31")
def test_a_liar_about_the_length_does_not_hang_the_service(running):
    address = urlsplit(running.url)
    with socket.create_connection((address.hostname, address.port)) as peer:
        peer.sendall(b"POST /api/session HTTP/1.1\r\nHost: x\r\nContent-Length: 1000\r\n\r\n{")
    with running.client() as client:
        assert client.get("/status").status_code == 200


def test_every_answer_is_hardened(running):
    with running.client(Role.AUDITOR) as client:
        for path in ("/status", "/nothing"):
            headers = client.get(path).headers
            assert headers["x-content-type-options"] == "nosniff"
            assert headers["cache-control"] == "no-store"
            assert "frame-ancestors 'none'" in headers["content-security-policy"]
            assert "server" not in headers


def test_a_fault_of_the_service_tells_an_incident_number_and_nothing_else():
    app = FastAPI()
    add_problem_handlers(app)

    @app.get("/fault")
    def fault() -> None:
        raise RuntimeError("patient Doe, table users, password")

    transport = httpx.ASGITransport(app, raise_app_exceptions=False)

    async def ask() -> httpx.Response:
        async with httpx.AsyncClient(transport=transport, base_url="http://test") as client:
            return await client.get("/fault")

    response = asyncio.run(ask())
    problem = _problem(response)
    assert (problem["status"], problem["code"]) == (500, "internal_fault")
    assert problem["incident"]
    assert "Doe" not in response.text
    assert "RuntimeError" not in response.text


@pytest.mark.hazard("H31", "H32")
def test_half_sent_requests_keep_nobody_from_stopping_and_asking(running):
    """Slow clients by the hundred: each sends the head of a request and never its end."""
    address = urlsplit(running.url)
    with ExitStack() as open_connections, running.client() as client:
        for _ in range(200):
            peer = open_connections.enter_context(socket.create_connection((address.hostname, address.port), timeout=5))
            peer.sendall(b"POST /api/stop HTTP/1.1\r\nHost: x\r\nContent-Le")
        assert client.post("/stop").status_code == 200
        assert client.get("/status").status_code == 200

"""The public Python client: what it raises, what it sends, and what it never sends twice."""

import doctest
import socket
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import coaxial_client
from coaxial_client import Case, Coaxial, NoAnswer, Refused
from service.auth.permissions import Role

_PASSWORD = "correct horse"
_CASE = {
    "patient_id": "P1",
    "study_uid": "1.2.3",
    "targets": [{"name": "L3 left", "entry_mm": [32.0, 85.0, 12.0], "target_mm": [20.0, 40.0, 4.0]}],
}


@pytest.fixture
def surgeon(running) -> Iterator[Coaxial]:
    with Coaxial(running.url) as client:
        client.sign_in(Role.SURGEON.value, _PASSWORD)
        yield client


@pytest.fixture
def case(surgeon, device_files) -> Iterator[Case]:
    for kind, content in device_files.items():
        surgeon.upload_device(kind, content.encode())
    opened = surgeon.open_case(_CASE)
    yield opened
    opened.command("case-aborted", reason="end of the test")


class Deaf:
    """A service that takes requests and says nothing, or part of an answer."""

    def __init__(self, answer: bytes) -> None:
        self._answer = answer
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.url = f"http://127.0.0.1:{self._socket.getsockname()[1]}"
        self.heard: list[bytes] = []
        self._over = threading.Event()
        self._thread = threading.Thread(target=self._listen)
        self._thread.start()

    def _listen(self) -> None:
        while not self._over.is_set():
            connection, _ = self._socket.accept()
            with connection:
                if request := connection.recv(65536):
                    self.heard.append(request)
                    connection.sendall(self._answer)
                if not self._answer:
                    self._over.wait()

    def close(self) -> None:
        self._over.set()
        socket.create_connection(self._socket.getsockname()).close()
        self._thread.join()
        self._socket.close()


@contextmanager
def _deaf(answer: bytes = b"") -> Iterator[Deaf]:
    deaf = Deaf(answer)
    try:
        yield deaf
    finally:
        deaf.close()


def test_the_example_in_the_package_is_true(running) -> None:
    given = {"Coaxial": Coaxial, "url": running.url, "password": _PASSWORD}
    assert doctest.testmod(coaxial_client, extraglobs=given) == (0, 1)


def test_after_signing_out_the_session_is_over(running) -> None:
    with Coaxial(running.url) as client:
        client.sign_in(Role.OPERATOR.value, pin="2468")
        assert client.get("/session")["role"] == "operator"
        client.sign_out()
        with pytest.raises(Refused) as caught:
            client.get("/session")
    assert (caught.value.status, caught.value.code) == (401, "not_signed_in")


def test_a_refusal_says_what_was_measured_against_which_limit(case) -> None:
    case.command("guide-state-stated", guide="empty")
    with pytest.raises(Refused) as caught:
        case.command("carm-position-confirmed")
    refused = [verdict for verdict in caught.value.verdicts if not verdict["passed"]]
    assert [verdict["code"] for verdict in refused] == ["at_rest"]
    assert {"measured", "limit", "unit", "hazard"} <= refused[0].keys()
    assert caught.value.what_to_do


def test_a_service_that_is_not_there_gives_no_answer() -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        url = f"http://127.0.0.1:{taken.getsockname()[1]}"
    with Coaxial(url) as client, pytest.raises(NoAnswer):
        client.status()
    with Coaxial(url) as client, pytest.raises(NoAnswer), client.case("c").hold("p"):
        pass


def test_a_command_without_an_answer_is_not_sent_again() -> None:
    with _deaf() as deaf, Coaxial(deaf.url, timeout_s=0.2) as client:
        case = client.case("c")
        case.version = 3
        with pytest.raises(NoAnswer):
            case.command("move-approved", plan_id="p", pin="2468")
        assert len(deaf.heard) == 1
    assert b'If-Match: "3"' in deaf.heard[0]


def test_a_download_that_breaks_off_leaves_no_file(tmp_path: Path) -> None:
    half = b"HTTP/1.1 200 OK\r\nContent-Length: 1000\r\n\r\nhalf"
    with _deaf(half) as deaf, Coaxial(deaf.url) as client, pytest.raises(NoAnswer):
        client.case("c").export(tmp_path / "case.zip")
    assert list(tmp_path.iterdir()) == []


def test_the_ledger_is_written_to_a_file_and_a_refused_one_to_none(surgeon, running, case, tmp_path) -> None:
    written = surgeon.export_audit(tmp_path / "audit.csv", "csv", case=case.id)
    assert written.read_text().startswith("sequence,")
    assert case.id in written.read_text()
    with Coaxial(running.url) as client:
        client.sign_in(Role.OPERATOR.value, _PASSWORD)
        with pytest.raises(Refused):
            client.export_audit(tmp_path / "none.csv")
    assert list(tmp_path.iterdir()) == [written]


def test_signs_of_life_do_not_lengthen_a_wait(case, monkeypatch) -> None:
    monkeypatch.setattr("service.conductor.events._KEEP_ALIVE_S", 0.05)
    with pytest.raises(TimeoutError, match="no event came"):
        next(case.events(case.status()["sequence"], quiet_s=0.4))


def test_a_wait_ends_with_the_event_and_names_the_state_where_none_comes(case) -> None:
    after = case.status()["sequence"]
    with pytest.raises(TimeoutError, match="case is case_open, not verified"):
        case.wait_for("verified", timeout_s=0.3)
    with pytest.raises(TimeoutError, match="no stop"):
        case.await_event("stop", after=after, timeout_s=0.3)
    speaker = threading.Timer(0.2, case.stop)
    speaker.start()
    assert case.wait_for("safe_hold")["held_for"] == "stop"
    speaker.join()
    assert case.await_event("stop", after=after)["state"] == "safe_hold"
    assert next(case.events(after))["trigger"] == "stop"

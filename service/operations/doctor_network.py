"""What `coaxial doctor` looks at over the network: ports of this machine's, the arm, the hospital's peers."""

import errno
import socket
from collections.abc import Iterable

import httpx
from pynetdicom import PYNETDICOM_UID_PREFIX
from pynetdicom.sop_class import Verification

from robot.dashboard import DASHBOARD_PORT
from service.conductor.check_items import CheckItem, item
from service.errors import ServiceError, answer_for
from service.pacs.peer import association_with
from service.settings import DicomSettings, PeerSettings, Settings

_RTDE_PORT = 30004
_CONNECT_S = 1.0
_ASK_S = 5.0
_ANOTHER_PROGRAM = "Another program has the port: end it, or name another one in `{setting}`."
_ANYWHERE = {"0.0.0.0": "127.0.0.1", "::": "::1"}  # noqa: S104  where such a listener is asked


def arm(settings: Settings) -> Iterable[CheckItem]:
    """Whether the controller listens; nothing is asked of it, so that nobody's motion is disturbed."""
    if settings.arm_address is None:
        return
    cure = "Switch the controller on; check its network, `arm_address`, and that remote control is enabled."
    for code, port in (("arm_dashboard", DASHBOARD_PORT), ("arm_rtde", _RTDE_PORT)):
        yield item(code, _listens(settings.arm_address, port), _at(settings.arm_address, port), "listens", "", cure)


def http(settings: Settings) -> Iterable[CheckItem]:
    """Whether the port is this machine's, and free or a running service's."""
    host, port = settings.http.host, settings.http.port
    cure = "Name an address of this machine in `http.host`, and a port that this user may open in `http.port`."
    here = _is_here(host, port)
    yield item("http_port", here, _at(host, port), "this machine's", "", cure)
    if here and port and _listens(host, port):
        cure = _ANOTHER_PROGRAM.format(setting="http.port")
        yield item("http_service", _is_a_service(host, port), _at(host, port), "a service", "", cure)


def dicom(settings: Settings) -> Iterable[CheckItem]:
    """Whether anybody may send, and the port is this machine's, and free or a running service's."""
    receiver = settings.dicom
    callers = ", ".join(receiver.accepted_callers)
    cure = "Name the C-arm's AE title in `dicom.accepted_callers`: nobody else may send."
    yield item("dicom_callers", bool(callers), callers, "an AE title", "", cure)
    here, where = _is_here(receiver.host, receiver.port), _at(receiver.host, receiver.port)
    cure = "Name an address of this machine in `dicom.host`, and a port that this user may open in `dicom.port`."
    yield item("dicom_port", here, where, "this machine's", "", cure)
    if here and callers and receiver.port and _listens(receiver.host, receiver.port):
        cure = _ANOTHER_PROGRAM.format(setting="dicom.port")
        yield item("dicom_service", _is_a_receiver(receiver), where, "a service", "", cure)


def peers(settings: Settings) -> Iterable[CheckItem]:
    """The hospital's archive and worklist answer an echo, where they are named."""
    for code, peer in (("archive", settings.pacs), ("worklist", settings.worklist)):
        if peer.host is not None:
            answers = _echoes(peer, settings.dicom.ae_title)
            yield item(code, answers, peer.ae_title, "answers", "", answer_for("peer_unreachable").what_to_do)


def _echoes(peer: PeerSettings, calling: str) -> bool:
    """Within the time that the service grants them, too."""
    try:
        with association_with(peer, calling, [Verification]) as association:
            return "Status" in association.send_c_echo()
    except ServiceError:
        return False


def _is_a_receiver(receiver: DicomSettings) -> bool:
    """Whether what listens there speaks DICOM as a service's receiver does; a PACS answers an echo, too."""
    peer = PeerSettings(host=_asked(receiver.host), port=receiver.port, ae_title=receiver.ae_title)
    try:
        with association_with(peer, receiver.accepted_callers[0], [Verification], _ASK_S) as association:
            told = association.acceptor.implementation_class_uid
    except ServiceError:
        return False
    return told is not None and told.startswith(PYNETDICOM_UID_PREFIX)


def _listens(host: str, port: int) -> bool:
    try:
        socket.create_connection((host, port), _CONNECT_S).close()
    except OSError:
        return False
    return True


def _is_a_service(host: str, port: int) -> bool:
    """Whether what listens there answers as a service that runs does."""
    try:
        address = f"http://{_at(_asked(host), port)}/api/health/live"
        answer = httpx.get(address, timeout=_ASK_S, trust_env=False)
        return answer.is_success and answer.json().get("status") == "up"
    except (httpx.HTTPError, ValueError, AttributeError):
        return False


def _is_here(host: str, port: int) -> bool:
    """Whether the address is this machine's, and its port free or in use, then by a service that runs."""
    try:
        [(family, *_, address), *_] = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM, flags=socket.AI_PASSIVE)
        socket.create_server(address[:2], family=family).close()
    except OSError as error:
        return error.errno == errno.EADDRINUSE
    return True


def _asked(host: str) -> str:
    """Where a listener on every address is asked."""
    return _ANYWHERE.get(host, host)


def _at(host: str, port: int) -> str:
    return f"[{host}]:{port}" if ":" in host else f"{host}:{port}"

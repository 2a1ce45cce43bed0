"""The DICOM port: few connections at a time, among which a C-arm finds room beside those that say nothing (H31).

Each connection costs two threads, one of which looks for news a thousand times a second, and pynetdicom asks by
select(), which knows no descriptor from 1024 on. Its own bound counts whoever merely connected; for the rest of a unit
that has begun it waits for ever, and it makes room for one of 4 GB.
"""

import socket
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from functools import partial
from socketserver import BaseServer
from typing import Any

import structlog
from pynetdicom import evt
from pynetdicom.association import Association
from pynetdicom.transport import AssociationServer

_log = structlog.get_logger(__name__)

MOST_CONNECTIONS = 16
"""More than the C-arms and workstations that send to one room at the same time."""
INTRODUCED_WITHIN_S = 10.0
"""From connecting to the whole request for an association, which a C-arm sends at once."""
PDU_BYTES = 131_072
"""The greatest unit that dcmtk sends. Each costs Python some work, which the rest of the service waits for."""
_FIRST_NOT_SELECTABLE = 1024  # FD_SETSIZE, which is part of the system's interface
_HUNG_UP_WITHIN_S = 1.0  # it takes milliseconds


class DicomPort(AssociationServer):  # type: ignore[misc]  # pynetdicom tells no types
    """A server of associations; where it is full, the peer with most strangers loses its oldest."""

    def __init__(self, *given: Any, **named: Any) -> None:
        super().__init__(*given, **named)
        self.bind(evt.EVT_CONN_OPEN, _on_connected)

    def get_request(self) -> tuple[socket.socket, tuple[str, int]]:
        """Accept a connection; of a unit that has begun more must come in time."""
        request, address = super().get_request()
        request.settimeout(self.ae.network_timeout)
        return request, address

    def verify_request(self, request: Any, client_address: Any) -> bool:
        """Whether there is room for one more; a stranger's is given to it."""
        if request.fileno() >= _FIRST_NOT_SELECTABLE:
            problem = "too many open files"
        elif len(self.active_associations) < MOST_CONNECTIONS or self._make_room():
            return True
        else:
            problem = "too many associations"
        _log.warning("dicom_connection_refused", address=client_address[0], problem=problem)
        return False

    def service_actions(self) -> None:
        """Hang up on who does not say who it is; called ten times a second.

        pynetdicom's own searches for garbage here, while every thread of the service waits.
        """
        last_s = time.monotonic() - INTRODUCED_WITHIN_S
        for stranger in self._strangers():
            if stranger.coaxial_since_s < last_s:
                _hang_up(stranger)

    def shutdown(self) -> None:
        """Listen no more; pynetdicom's own takes the server out of a list in which only it puts servers."""
        BaseServer.shutdown(self)
        self.server_close()

    def _strangers(self) -> list[Association]:
        """Connections on which no association was asked for."""
        return [one for one in self.active_associations if one.requestor.primitive is None]

    def _make_room(self) -> bool:
        strangers = self._strangers()
        if not strangers:
            return False
        ((peer, _),) = Counter(one.requestor.address for one in strangers).most_common(1)
        of_peer = (one for one in strangers if one.requestor.address == peer)
        return _hang_up(min(of_peer, key=lambda one: one.coaxial_since_s))


def _on_connected(event: Any) -> None:
    event.assoc.coaxial_since_s = time.monotonic()
    stream = event.assoc.dul.socket
    stream.recv = partial(_received, stream.recv)


def _received(read: Callable[[int], bytearray], length: int) -> bytearray:
    """So many bytes of a unit; OSError, which ends the connection, where nobody may send that many."""
    if length > PDU_BYTES:
        raise OSError(f"a unit of {length} bytes, of {PDU_BYTES} at most")
    return read(length)


def _hang_up(stranger: Association) -> bool:
    """Whether it is gone."""
    _log.warning("dicom_connection_ended", address=stranger.requestor.address, problem="no association asked for")
    with suppress(OSError, AttributeError):  # it may have gone by itself meanwhile
        stranger.dul.socket.socket.shutdown(socket.SHUT_RDWR)
    stranger.dul.to_user_queue.put(None)  # as if its time for a request were over
    stranger.join(_HUNG_UP_WITHIN_S)
    return not stranger.is_alive()

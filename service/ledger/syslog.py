"""Signed checkpoints to another machine: syslog over TLS (RFC 5424 messages, RFC 5425 transport).

What was not sent while the receiver was down is still in the database; a small file says how far it got.
"""

import os
import socket
import ssl
from collections.abc import Sequence
from pathlib import Path

import sqlalchemy as sa
import structlog

from service.database import tables
from service.database.engines import Database
from service.settings import AuditSettings

_log = structlog.get_logger(__name__)
_TIMEOUT_S = 5.0
_A_TIME = 500
# RFC 5424: facility 13 (log audit), severity 5 (notice).
_PRIORITY = 13 * 8 + 5
_NAME = "coaxial"


class CheckpointSender:
    """Sends every checkpoint once, in order, whenever the receiver can be reached."""

    def __init__(self, settings: AuditSettings, database: Database, sent_file: Path) -> None:
        self._settings = settings
        self._database = database
        self._sent_file = sent_file

    def send_new(self) -> None:
        """Send what is not sent yet; a receiver that is down is tried again with the next call."""
        while new := self._unsent():
            try:
                self._send([_message(*one) for one in new])
            except OSError as error:
                _log.warning("checkpoints_wait", waiting=len(new), reason=str(error))
                return
            self._note_sent(new[-1][0])

    def _unsent(self) -> list[tuple[int, str, str]]:
        table = tables.checkpoints.c
        query = sa.select(table.sequence, table.statement, table.signature).where(table.sequence > self._sent())
        with self._database.read() as connection:
            return [tuple(row) for row in connection.execute(query.order_by(table.sequence).limit(_A_TIME))]

    def _send(self, messages: Sequence[bytes]) -> None:
        ca_file = self._settings.syslog_ca_file
        context = ssl.create_default_context(cafile=str(ca_file) if ca_file else None)
        address = (str(self._settings.syslog_host), self._settings.syslog_port)
        with (
            socket.create_connection(address, _TIMEOUT_S) as plain,
            context.wrap_socket(plain, server_hostname=address[0]) as secured,
        ):
            for message in messages:
                secured.sendall(b"%d %s" % (len(message), message))
            secured.unwrap()  # RFC 5425, 4.4: the receiver answers the closing, after all that came before it

    def _sent(self) -> int:
        return int(self._sent_file.read_text()) if self._sent_file.exists() else 0

    def _note_sent(self, sequence: int) -> None:
        part = self._sent_file.with_suffix(".part")
        part.write_text(str(sequence))
        part.replace(self._sent_file)


def _message(sequence: int, statement: str, signature: str) -> bytes:
    """One message: the number in its structured data, statement and signature as its text."""
    head = f"<{_PRIORITY}>1 - {socket.gethostname()} {_NAME} {os.getpid()} checkpoint"
    return f'{head} [checkpoint@32473 sequence="{sequence}"] {statement} {signature}'.encode()

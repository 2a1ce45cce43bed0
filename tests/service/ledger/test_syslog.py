"""Checkpoints over TLS to a receiver that is there, is down, and comes back (RFC 5425)."""

import json
import socket
import threading

import pytest

from service.ledger.checkpoints import sign_head
from service.ledger.entries import head_of
from service.ledger.syslog import CheckpointSender
from service.settings import AuditSettings


class Receiver:
    """Takes messages by the counted frames of RFC 5425 until it is closed."""

    def __init__(self, certificate, port: int = 0) -> None:
        self._context = certificate.server_context()
        self._socket = socket.create_server(("127.0.0.1", port))
        self._socket.settimeout(10)
        self.port = self._socket.getsockname()[1]
        self.messages: list[str] = []
        self._thread = threading.Thread(target=self._take_one_connection)
        self._thread.start()

    def _take_one_connection(self) -> None:
        plain, _ = self._socket.accept()
        with plain, self._context.wrap_socket(plain, server_side=True) as secured:
            stream = b""
            while part := secured.recv(65536):
                stream += part
            secured.unwrap()
            while stream:
                size, _, rest = stream.partition(b" ")
                self.messages.append(rest[: int(size)].decode())
                stream = rest[int(size) :]

    def close(self) -> list[str]:
        self._thread.join()
        self._socket.close()
        return self.messages


def _sender(record, database, certificate, port):
    settings = AuditSettings(syslog_host="localhost", syslog_port=port, syslog_ca_file=certificate.file)
    return CheckpointSender(settings, database, record.folder / "sent")


def _numbers(messages):
    return [json.loads(message.split("] ", 1)[1].rsplit(" ", 1)[0])["sequence"] for message in messages]


def test_checkpoints_wait_for_the_receiver_and_arrive_once_and_in_order(record, certificate):
    database = record.open()
    with database.read() as connection:
        kept = list(connection.exec_driver_sql("SELECT sequence FROM checkpoints ORDER BY sequence").scalars())
    receiver = Receiver(certificate)
    sender = _sender(record, database, certificate, receiver.port)
    sender.send_new()
    messages = receiver.close()
    assert _numbers(messages) == kept
    assert messages[0].startswith("<109>1 - ")

    with database.write() as connection:
        sign_head(connection, head_of(connection), record.signer, "hour")
    sender.send_new()  # nobody listens
    receiver = Receiver(certificate, receiver.port)
    _sender(record, database, certificate, receiver.port).send_new()  # of the next run
    assert len(_numbers(receiver.close())) == 1
    database.close()


def test_a_receiver_of_another_name_gets_nothing(record, certificate, tmp_path):
    database, receiver = record.open(), Receiver(certificate)
    settings = AuditSettings(syslog_host="localhost", syslog_port=receiver.port)  # the system's authorities know it not
    sender = CheckpointSender(settings, database, tmp_path / "sent")
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(threading, "excepthook", lambda _: None)
        sender.send_new()
        assert receiver.close() == []
    assert not (tmp_path / "sent").exists()
    database.close()

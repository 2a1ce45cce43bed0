"""Connections to a PostgreSQL server that may fall silent: behind a network that is down, over a disk that hangs.

By itself neither side notices for hours: requests wait without an end, and the server keeps the turn to write, which
every room shares, for a service that is gone.
"""

from typing import Any

import psycopg
import sqlalchemy as sa
from psycopg.abc import PQGen
from psycopg.pq import TransactionStatus
from sqlalchemy.engine import Engine

BUSY_S = 15.0
"""A turn to write is waited for so long, and a service waits so long for an answer."""

_ABANDONED_S = 60.0  # what a write does between two statements takes far less
# Three looks at a silent peer, 5 s apart; none of it is asked of a socket of the machine itself.
_PEER = {"keepalives_idle": 5, "keepalives_interval": 5, "keepalives_count": 3, "tcp_user_timeout": 15_000}
_CONNECT_S = 5
_LOOK_S = 0.1


class NoAnswerError(psycopg.OperationalError):
    """The server did not answer in time."""


class _Connection(psycopg.Connection[Any]):
    """One that may be told how long an answer is waited for."""

    answer_within_s: float | None = None

    def wait(self, gen: PQGen[Any], interval: float = _LOOK_S, timeout: float | None = None) -> Any:
        """As psycopg's; where the answer does not come in time, the connection is given up."""
        try:
            return super().wait(gen, interval, self.answer_within_s if timeout is None else timeout)
        except psycopg.OperationalError as error:
            if self.pgconn.transaction_status != TransactionStatus.ACTIVE:
                raise
            self.close()  # whatever comes now belongs to no statement
            raise NoAnswerError(f"no answer within {self.answer_within_s} s") from error


def postgresql_engine(address: sa.URL, *, writes: bool, options: dict[str, Any]) -> Engine:
    """An engine whose connections notice a peer that is gone, on both sides."""
    level = "READ COMMITTED" if writes else "REPEATABLE READ"
    connect_args = {"connect_timeout": _CONNECT_S, **_PEER}
    options = {"pool_timeout": BUSY_S, "isolation_level": level, **options}
    engine = sa.create_engine(address, **options, connect_args=connect_args)

    @sa.event.listens_for(engine, "do_connect")
    def connect(_dialect: Any, _record: Any, arguments: Any, named: Any) -> psycopg.Connection[Any]:
        return _Connection.connect(*arguments, **named)

    @sa.event.listens_for(engine, "connect")
    def prepare(dbapi: psycopg.Connection[Any], _record: Any) -> None:
        for name, value in _server_settings(writes=writes).items():
            dbapi.execute(f"SET {name} = {value}")
        dbapi.commit()  # else the next rollback takes them back

    return engine if writes else engine.execution_options(postgresql_readonly=True)


def expect_answers(engine: Engine, within_s: float) -> None:
    """Give up, from the next use of each connection on, a statement that is not answered in time."""

    @sa.event.listens_for(engine, "checkout")
    def bound(dbapi: Any, _record: Any, _proxy: Any) -> None:
        dbapi.answer_within_s = within_s


def _server_settings(*, writes: bool) -> dict[str, int]:
    """What the server is asked of a session, in ms but for those of TCP, which are in s and looks."""
    settings = {f"tcp_{name}" if name.startswith("keep") else name: value for name, value in _PEER.items()}
    settings["lock_timeout"] = round(1000.0 * BUSY_S)
    if writes:  # a reader may calculate for longer between two looks, and keeps nobody waiting
        settings["idle_in_transaction_session_timeout"] = round(1000.0 * _ABANDONED_S)
    return settings

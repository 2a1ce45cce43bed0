"""When each session was last used: known at once, written behind the requests, which must not wait for a writer."""

import threading
from concurrent.futures import ThreadPoolExecutor

import sqlalchemy as sa
import structlog

from service.database import tables
from service.database.engines import Database
from service.errors import ServiceError

_log = structlog.get_logger(__name__)


class SessionUses:
    """Uses since the start, in seconds of the wall clock; what is lost on the way to the database locks sooner."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._newest_s: dict[str, float] = {}
        self._waiting: set[str] = set()
        self._changing = threading.Lock()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="session-uses")

    def newest_s(self, session_id: str, written_s: float) -> float:
        """The last use of a session, of which the database says `written_s`."""
        return max(written_s, self._newest_s.get(session_id, written_s))

    def note(self, session_id: str, at_s: float) -> None:
        """A use; at most one of a session waits to be written, beside the one that is being written."""
        with self._changing:
            self._newest_s[session_id] = at_s
            if session_id in self._waiting:
                return
            self._waiting.add(session_id)
        self._thread.submit(self._write, session_id)

    def forget(self, session_id: str) -> None:
        """From now on the database alone is asked: the session is over, or was unlocked by another clock."""
        with self._changing:
            self._newest_s.pop(session_id, None)

    def close(self) -> None:
        """Wait for the write that has begun, and leave the others."""
        self._thread.shutdown(cancel_futures=True)

    def _write(self, session_id: str) -> None:
        with self._changing:
            self._waiting.discard(session_id)
            at_s = self._newest_s.get(session_id)
        if at_s is None:
            return
        changed = sa.update(tables.sessions).where(tables.sessions.c.id == session_id).values(last_seen_at_s=at_s)
        try:
            with self._database.write() as connection:
                connection.execute(changed)
        except ServiceError as error:  # a full disk or a busy writer must not sign anybody out
            _log.warning("session_use_not_noted", code=error.code)

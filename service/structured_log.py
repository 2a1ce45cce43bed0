"""The log: event names and ids as JSON lines on stderr, never patient data; the audit trail is rows, not this.

What libraries log, warn of and fail with goes out in the same form. Their words may quote a DICOM header or a row of
the database: only those are kept whose libraries see neither, of all others and of every exception where it came from.
"""

import logging
import sys
import threading
import warnings
from collections.abc import Iterator
from pathlib import Path
from traceback import extract_tb
from types import TracebackType
from typing import Any, TextIO

import structlog
from structlog.typing import EventDict, Processor

_log = structlog.get_logger(__name__)

# They see addresses and schema versions. pynetdicom and pydicom quote values, asyncio the exceptions of tasks.
_QUOTED = frozenset({"uvicorn", "alembic"})
_DEEPEST_CAUSE = 10  # an exception may name itself as its cause


def configure_log(level: int = logging.INFO) -> None:
    """Write structured events, what libraries log at warning or above, warnings and uncaught exceptions to stderr."""
    stamped: list[Processor] = [
        structlog.processors.add_log_level,
        structlog.processors.TimeStamper(fmt="iso", utc=True),
    ]
    formed: list[Processor] = [
        structlog.processors.ExceptionRenderer(lambda failure: exception_places(failure[1])),
        structlog.processors.JSONRenderer(),
    ]
    structlog.configure(
        processors=[structlog.contextvars.merge_contextvars, *stamped, *formed],
        wrapper_class=structlog.make_filtering_bound_logger(level),
        # a line in one write, so that what a library logs meanwhile does not end up in it
        logger_factory=structlog.WriteLoggerFactory(sys.stderr),
        cache_logger_on_first_use=True,
    )
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(foreign_pre_chain=[_without_patients, *stamped], processors=formed)
    )
    # Below warning pynetdicom logs whole data sets, with names.
    logging.basicConfig(level=logging.WARNING, handlers=[handler], force=True)
    _tell_what_nobody_caught()


def _without_patients(_logger: Any, _method: str, event: EventDict) -> EventDict:
    """Who logged, and where; the words only of those that quote nobody."""
    record: logging.LogRecord = event["_record"]
    told = {"event": "library_said", "logger": record.name, "where": f"{record.module}:{record.lineno}"}
    if record.name.partition(".")[0] in _QUOTED:
        told["said"] = event["event"].strip()
    return told | {"exc_info": event.get("exc_info")}


def _tell_what_nobody_caught() -> None:
    warnings.showwarning = _show_warning
    sys.excepthook = _tell_uncaught
    threading.excepthook = lambda told: _tell_uncaught(told.exc_type, told.exc_value, told.exc_traceback)
    sys.unraisablehook = lambda told: _tell_uncaught(told.exc_type, told.exc_value, told.exc_traceback)


def _show_warning(
    message: Warning | str,  # noqa: ARG001  # it may quote a patient
    category: type[Warning],
    filename: str,
    lineno: int,
    file: TextIO | None = None,  # noqa: ARG001  # the log has one place
    line: str | None = None,  # noqa: ARG001
) -> None:
    _log.warning("python_warning", category=category.__name__, where=f"{Path(filename).name}:{lineno}")


def _tell_uncaught(kind: type[BaseException], error: BaseException | None, traceback: TracebackType | None) -> None:
    _log.critical("uncaught", exc_info=(kind, error or kind(), traceback))


def exception_places(error: BaseException) -> list[str]:
    """An exception and what caused it: the type of each, and where it came from, innermost first; not what it says."""
    return [" < ".join([type(one).__name__, *_places(one)]) for one in _causes(error)]


def _causes(error: BaseException | None) -> Iterator[BaseException]:
    for _ in range(_DEEPEST_CAUSE):
        if error is None:
            return
        yield error
        error = error.__cause__ or error.__context__


def _places(error: BaseException) -> list[str]:
    return [f"{Path(place.filename).name}:{place.lineno}" for place in reversed(extract_tb(error.__traceback__))]

"""The log: events as JSON lines on stderr, never patient data; the audit trail is rows, not this."""

import logging
import sys
import traceback
import warnings
from types import TracebackType

import structlog
from structlog.typing import EventDict, Processor, WrappedLogger

_ExcInfo = tuple[type[BaseException], BaseException, TracebackType | None] | tuple[None, None, None]


def configure_log(level: int = logging.INFO) -> None:
    """Write structured events, and what libraries log at warning or above, to stderr, a JSON object a line."""
    common: list[Processor] = [
        structlog.contextvars.merge_contextvars,
        structlog.processors.add_log_level,
        structlog.processors.TimeStamper(fmt="iso", utc=True),
    ]
    structlog.configure(
        processors=[*common, structlog.processors.format_exc_info, structlog.processors.JSONRenderer()],
        wrapper_class=structlog.make_filtering_bound_logger(level),
        logger_factory=structlog.PrintLoggerFactory(sys.stderr),
        cache_logger_on_first_use=True,
    )
    # pynetdicom logs whole data sets, with names, below warning.
    logging.basicConfig(level=logging.WARNING, handlers=[_of_libraries(common)])
    logging.captureWarnings(True)
    # pydicom quotes values that it dislikes, by warning and by log: a patient's name is one
    warnings.filterwarnings("ignore", module="pydicom")
    logging.getLogger("pydicom").setLevel(logging.CRITICAL)


def _of_libraries(common: list[Processor]) -> logging.Handler:
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(
        structlog.stdlib.ProcessorFormatter(
            foreign_pre_chain=[*common, structlog.stdlib.add_logger_name, _without_what_was_said],
            processors=[
                structlog.stdlib.ProcessorFormatter.remove_processors_meta,
                structlog.processors.JSONRenderer(),
            ],
        )
    )
    return handler


def _without_what_was_said(_logger: WrappedLogger, _method: str, event: EventDict) -> EventDict:
    """An exception's kind and where it arose, for a library's may quote what it was given: a patient's name is such."""
    about: _ExcInfo = event.pop("exc_info", None) or (None, None, None)
    kind, _, where = about
    if kind is not None:
        event["exception"] = "".join(traceback.format_tb(where)) + kind.__name__
    return event

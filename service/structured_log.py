"""The log: event names and ids as JSON lines on stderr, never patient data; the audit trail is rows, not this."""

import logging
import sys

import structlog


def configure_log(level: int = logging.INFO) -> None:
    """Write structured events, and what libraries log at warning or above, to stderr."""
    structlog.configure(
        processors=[
            structlog.contextvars.merge_contextvars,
            structlog.processors.add_log_level,
            structlog.processors.TimeStamper(fmt="iso", utc=True),
            structlog.processors.format_exc_info,
            structlog.processors.JSONRenderer(),
        ],
        wrapper_class=structlog.make_filtering_bound_logger(level),
        logger_factory=structlog.PrintLoggerFactory(sys.stderr),
        cache_logger_on_first_use=True,
    )
    # pynetdicom logs whole data sets, with names, below warning.
    logging.basicConfig(level=logging.WARNING, stream=sys.stderr, format="%(levelname)s %(name)s %(message)s")

"""The wall clock as records carry it."""

from datetime import UTC, datetime


def now_utc() -> str:
    """The time now as text of fixed width, UTC, microseconds."""
    return datetime.now(UTC).strftime("%Y-%m-%dT%H:%M:%S.%fZ")

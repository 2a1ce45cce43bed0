"""The wall clock as records carry it."""

from datetime import UTC, datetime


def now_utc() -> str:
    """The time now as text of fixed width, UTC, microseconds."""
    return as_utc(datetime.now(UTC))


def as_utc(time: datetime) -> str:
    """A time in that form; one without a zone is UTC already."""
    zoned = time if time.tzinfo is not None else time.replace(tzinfo=UTC)
    return zoned.astimezone(UTC).strftime("%Y-%m-%dT%H:%M:%S.%fZ")

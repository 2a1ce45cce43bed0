"""Who speaks to the service: from which machine, with which program; known at the edge, written into the ledger."""

from contextvars import ContextVar

# The service itself, where nobody asked: observations of the guard, images that arrive.
SPEAKER: ContextVar[str] = ContextVar("speaker", default="service")
_LONGEST = 160


def speak_as(address: str, program: str) -> None:
    """Name the client of the request or command that runs from here on."""
    SPEAKER.set(f"{address} {program}".strip()[:_LONGEST])

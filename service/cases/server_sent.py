"""An event as server-sent events say it: put into words once, however many follow the case."""

from dataclasses import dataclass

from service.cases.records import StoredEvent
from service.database.json_text import to_text

# A comment, which every reader of the format skips.
KEEP_ALIVE = b":\n\n"


@dataclass(frozen=True, slots=True)
class ServerSent:
    """The bytes of one event, and its number in the case."""

    sequence: int
    text: bytes


def server_sent(event: StoredEvent) -> ServerSent:
    """`id` is the sequence number, `event` the trigger, `data` the event as JSON."""
    body = {
        "sequence": event.sequence,
        "version": event.version,
        "trigger": event.trigger,
        "user_id": event.user_id,
        "state": event.state,
        "recorded_at": event.recorded_at,
        "data": event.data,
    }
    text = f"id: {event.sequence}\nevent: {event.trigger}\ndata: {to_text(body)}\n\n"
    return ServerSent(event.sequence, text.encode())

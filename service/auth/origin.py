"""Cross-site requests: a cookie or a WebSocket counts only from the service's own pages (H27)."""

from collections.abc import Collection
from urllib.parse import urlsplit

from starlette.requests import HTTPConnection

from service.errors import ErrorCode, ServiceError

_READS = frozenset({"GET", "HEAD", "OPTIONS"})


def check_origin(connection: HTTPConnection, allowed: Collection[str]) -> None:
    """Refuse a foreign Origin on whatever a browser could be tricked into; ServiceError ORIGIN_REFUSED.

    A request without Origin does not come from a page: browsers send one with every WebSocket and every POST.
    """
    origin = connection.headers.get("origin")
    if origin is None or (connection.scope["type"] == "http" and connection.scope["method"] in _READS):
        return
    host = connection.headers.get("host")
    if origin in allowed or (host and host == _host(origin)):
        return
    raise ServiceError(ErrorCode.ORIGIN_REFUSED, f"origin {origin} is not this service")


def _host(origin: str) -> str | None:
    """The host that an Origin names; None where it is no address."""
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return None

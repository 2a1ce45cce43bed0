"""The outermost layer of the web application: bounds what comes in, hardens what goes out (H31)."""

from collections.abc import Mapping

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from service.errors import ErrorCode, ServiceError
from service.ledger.speaker import speak_as
from service.problem_json import answer_error

_SECURITY_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; frame-ancestors 'none'; base-uri 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
    "Cache-Control": "no-store",
}
_NUL = b"%00"  # PostgreSQL knows no text with one: an export would break off behind its first line. No stop is a GET.


class Edge:
    """ASGI middleware: who speaks, a limit on bodies, counted as they arrive, and the security headers."""

    def __init__(self, app: ASGIApp, max_body_bytes: int, larger: Mapping[str, int]) -> None:
        self._app = app
        self._max_body_bytes = max_body_bytes
        self._larger = larger  # limits of single paths

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """One request or WebSocket."""
        if scope["type"] in ("http", "websocket"):
            speak_as((scope.get("client") or ("",))[0], Headers(scope=scope).get("user-agent", ""))
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def hardened(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                for name, value in _SECURITY_HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        if scope["method"] == "GET" and _NUL in scope["query_string"]:
            refusal = ServiceError(ErrorCode.MALFORMED_REQUEST, "the query holds a NUL")
            await answer_error(refusal)(scope, receive, hardened)
            return
        limit = self._larger.get(scope["path"], self._max_body_bytes)
        declared = Headers(scope=scope).get("content-length", "0")
        if declared.isdigit() and int(declared) > limit:
            await answer_error(_too_large(int(declared), limit))(scope, receive, hardened)
            return
        await self._app(scope, _counted(receive, limit), hardened)


def _counted(receive: Receive, limit: int) -> Receive:
    received = 0

    async def counted() -> Message:
        nonlocal received
        message = await receive()
        received += len(message.get("body", b""))
        if received > limit:  # a chunked body declares no length
            raise _too_large(received, limit)
        return message

    return counted


def _too_large(measured: int, limit: int) -> ServiceError:
    return ServiceError(ErrorCode.BODY_TOO_LARGE, "the body is too large, in bytes", measured=measured, limit=limit)

"""The outermost layer of the web application: bounds what comes in, hardens what goes out (H31)."""

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


class Edge:
    """ASGI middleware: who speaks, a limit on bodies, counted as they arrive, and the security headers."""

    def __init__(self, app: ASGIApp, max_body_bytes: int) -> None:
        self._app = app
        self._max_body_bytes = max_body_bytes

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

        declared = Headers(scope=scope).get("content-length", "0")
        if declared.isdigit() and int(declared) > self._max_body_bytes:
            await answer_error(self._too_large(int(declared)))(scope, receive, hardened)
            return
        await self._app(scope, self._counted(receive), hardened)

    def _counted(self, receive: Receive) -> Receive:
        received = 0

        async def counted() -> Message:
            nonlocal received
            message = await receive()
            received += len(message.get("body", b""))
            if received > self._max_body_bytes:  # a chunked body declares no length
                raise self._too_large(received)
            return message

        return counted

    def _too_large(self, measured: int) -> ServiceError:
        return ServiceError(
            ErrorCode.BODY_TOO_LARGE, "the body is too large, in bytes", measured=measured, limit=self._max_body_bytes
        )

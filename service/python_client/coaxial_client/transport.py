"""One service's HTTP interface: requests with a time limit each, every error typed, nothing sent twice."""

import json
import math
import ssl
import time
from collections.abc import Generator, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import httpx

from coaxial_client.answers import NoAnswer, Refused

Json = dict[str, Any]
_CONNECT_S = 5.0  # a service of the same hospital answers a connection in milliseconds
# A stream of events says every 5 s that it is alive.
_ALIVE_S = 20.0
_PART = ".part"
# For plain HTTP: to read the system's authorities for each client takes longer than a command does.
_TRUSTS_NOBODY = ssl.SSLContext(ssl.PROTOCOL_TLS_CLIENT)


class Transport:
    """Requests below /api of one service, as one session."""

    def __init__(self, url: str, timeout_s: float, ca_file: Path | None) -> None:
        self._url = url.rstrip("/")
        if ca_file is not None and not self._url.startswith("https:"):
            raise ValueError(f"a CA file is for an address that begins with https, not for {url}")
        self._tls = ssl.create_default_context(cafile=ca_file) if self._url.startswith("https:") else None
        self._timeout_s = timeout_s
        self.token = ""
        # no proxy and no credentials of the environment: what moves an arm goes where it was told to
        verify = self._tls or _TRUSTS_NOBODY
        self._http = httpx.Client(base_url=f"{self._url}/api", verify=verify, trust_env=False)

    @property
    def tls(self) -> ssl.SSLContext | None:
        """What a WebSocket is to be opened with; None where the service speaks plain HTTP."""
        return self._tls

    def websocket_url(self, path: str) -> str:
        """A path below /api as a WebSocket's address."""
        return f"{self._url.replace('http', 'ws', 1)}/api{path}"

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def request(self, method: str, path: str, **content: Any) -> httpx.Response:
        """One request, sent once.

        Raises
        ------
        Refused
            The service said no.
        NoAnswer
            Nothing came back within the time limit.
        """
        headers = self._authorised(content.pop("headers", None))
        timeout = httpx.Timeout(self._timeout_s, connect=_CONNECT_S)
        with _typed(f"{method} {path}"):
            response = self._http.request(method, path, headers=headers, timeout=timeout, **content)
        if response.is_error:
            raise Refused.from_body(response.status_code, response.content)
        return response

    def events(self, path: str, after: int, quiet_s: float | None) -> Generator[Json, None, None]:
        """Server-sent events behind sequence `after`, as they come, until the service ends the stream.

        Raises
        ------
        TimeoutError
            None came for `quiet_s`; told up to 5 s later, when the service says again that it is alive.
        Refused, NoAnswer
            As for any request; also where no sign of life came.
        """
        quiet_s, heard_s = quiet_s or math.inf, time.monotonic()
        with _typed(f"GET {path}"):
            try:
                with self._stream(path, {}, {"Last-Event-ID": str(after)}, min(quiet_s, _ALIVE_S)) as response:
                    for line in response.iter_lines():
                        if line.startswith("data:"):
                            yield json.loads(line.removeprefix("data:"))
                            heard_s = time.monotonic()
                        elif time.monotonic() - heard_s >= quiet_s:
                            raise TimeoutError(f"no event came for {quiet_s} s")
            except httpx.ReadTimeout:
                if time.monotonic() - heard_s < quiet_s:
                    raise
                raise TimeoutError(f"no event came for {quiet_s} s") from None

    def download(self, path: str, query: Mapping[str, Any], file: Path, quiet_s: float) -> Path:
        """Write an answer to a file as it comes; the file appears whole or not at all."""
        part = file.with_name(file.name + _PART)
        try:
            with _typed(f"GET {path}"), self._stream(path, query, {}, quiet_s) as response, part.open("wb") as out:
                for piece in response.iter_bytes():
                    out.write(piece)
            return part.replace(file)
        finally:
            part.unlink(missing_ok=True)

    @contextmanager
    def _stream(
        self, path: str, query: Mapping[str, Any], headers: Mapping[str, str], quiet_s: float
    ) -> Iterator[httpx.Response]:
        own, timeout = self._authorised(headers), httpx.Timeout(quiet_s, connect=_CONNECT_S)
        with self._http.stream("GET", path, params=dict(query), headers=own, timeout=timeout) as response:
            if response.is_error:
                raise Refused.from_body(response.status_code, response.read())
            yield response

    def _authorised(self, headers: Mapping[str, str] | None) -> dict[str, str]:
        own = {"Authorization": f"Bearer {self.token}"} if self.token else {}
        return own | dict(headers or {})


@contextmanager
def _typed(what: str) -> Iterator[None]:
    """NoAnswer for whatever the network does."""
    try:
        yield
    except httpx.TransportError as error:
        raise NoAnswer(f"{what}: {type(error).__name__} {error}".strip()) from error

"""One case as one user sees it: its status, its commands, its record, the held button."""

import time
from collections.abc import Generator, Mapping
from contextlib import closing
from pathlib import Path
from typing import TYPE_CHECKING, Any
from uuid import uuid4

from coaxial_client.answers import NoAnswer
from coaxial_client.hold import Button, Hold, HoldEnded
from coaxial_client.transport import Json, Transport

if TYPE_CHECKING:
    from coaxial_client.room import Coaxial

_LONGEST_HOLD_S = 120.0  # several times what the longest motion that the service plans takes


class Case:
    """One case, its version and lease as this client last saw them; a stale version is refused, never overwritten."""

    def __init__(self, room: "Coaxial", transport: Transport, case_id: str) -> None:
        self.room = room
        self._transport = transport
        self.id = case_id
        self.version = 0
        self.control_token: int | None = None

    def status(self) -> Json:
        """The atomic status; its version is what the next command is decided on."""
        status = self.room.get(f"/cases/{self.id}/status")
        self.version = int(status["version"])
        return status

    def command(self, name: str, **body: Any) -> Json:
        """Send a command, once, on the version last seen (read first, if none was).

        Raises
        ------
        Refused
            Not allowed now: `code`, `measured` and `limit`, `verdicts` of the interlocks, and what is possible instead.
        NoAnswer
            Whether it was carried out is not known: read the status before anything else.
        """
        if self.version == 0:
            self.status()
        headers = {"Idempotency-Key": uuid4().hex, "If-Match": f'"{self.version}"'}
        if self.control_token is not None:
            headers["Control-Token"] = str(self.control_token)
        answer = self.room.post(f"/cases/{self.id}/{name}", body, headers)
        self.version = int(answer.get("version") or self.version)
        return answer

    def take_lease(self, reason: str) -> int:
        """Take control; further commands carry the fencing token."""
        self.control_token = int(self.command("lease-taken", reason=reason)["detail"]["control_token"])
        return self.control_token

    def echo(self, image_id: str, pixel_px: tuple[float, float], space: str = "raw") -> Json:
        """The picked point as the server understood it, with a crop that shows it."""
        body = {"image_id": image_id, "pixel_px": list(pixel_px), "space": space}
        return self.room.post(f"/cases/{self.id}/target-echo", body)

    def plan(self, kind: str, **goal: Any) -> Json:
        """A checked path: length, rotation, duration, predicted error, and the plan's id under `made`."""
        return self.command("plan-requested", kind=kind, **goal)

    def approve(self, plan: Json, pin: str, overrides: Mapping[str, str] | None = None) -> str:
        """The surgeon's approval, with reasons for interlocks that it overrides; the id of the single-use permit."""
        body = {"plan_id": plan["made"]["plan"], "pin": pin, "overrides": dict(overrides or {})}
        return str(self.command("move-approved", **body)["made"]["permit"])

    def hold(self, permit_id: str, longest_s: float = _LONGEST_HOLD_S) -> Hold:
        """The held button of a permit, let go after `longest_s` at the latest."""
        token = "" if self.control_token is None else f"&control_token={self.control_token}"
        url = self._transport.websocket_url(f"/cases/{self.id}/hold?permit={permit_id}{token}")
        return Hold(Button(url, self._transport.token, self._transport.tls, longest_s), self._moved)

    def _moved(self, ended: HoldEnded) -> None:
        self.version = max(self.version, ended.version)

    def stop(self) -> Json:
        """Stop the arm."""
        return self.room.stop()

    def emergency_access(self) -> Json:
        """Stop the arm and leave it to whoever stands at the pendant; the case is held."""
        return self.room.post(f"/cases/{self.id}/emergency-access")

    def wait_for(self, *states: str, timeout_s: float = 30.0) -> Json:
        """The status once the case is in one of these states, woken by its events.

        A state that the case passes through in a moment may be missed; `await_event` misses nothing.

        Raises
        ------
        TimeoutError
            It is not after `timeout_s`; the text names the state it is in.
        """
        end_s = time.monotonic() + timeout_s
        while (status := self.status())["state"] not in states:
            if self._next_event(status["sequence"], end_s) is None:
                raise TimeoutError(f"case is {status['state']}, not {' or '.join(states)}, after {timeout_s} s")
        return status

    def await_event(self, *triggers: str, after: int, timeout_s: float = 30.0) -> Json:
        """The first event behind sequence `after` with one of these triggers, or of any trigger if none is named.

        Raises
        ------
        TimeoutError
            None came within `timeout_s`.
        """
        end_s = time.monotonic() + timeout_s
        while (event := self._next_event(after, end_s)) is not None:
            if not triggers or event["trigger"] in triggers:
                return event
            after = event["sequence"]
        raise TimeoutError(f"no {' or '.join(triggers) or 'event'} within {timeout_s} s")

    def events(self, after: int = 0, quiet_s: float | None = None) -> Generator[Json, None, None]:
        """Every event behind sequence `after`, then each new one as it happens; TimeoutError if none for `quiet_s`."""
        return self._transport.events(f"/cases/{self.id}/events", after, quiet_s)

    def _next_event(self, after: int, end_s: float) -> Json | None:
        """The one behind `after`; None if none comes in time. A stream each, for its time limit cannot be shortened."""
        left_s = end_s - time.monotonic()
        if left_s <= 0.0:
            return None
        with closing(self.events(after, left_s)) as events:
            try:
                return next(events)
            except TimeoutError:
                return None
            except StopIteration:
                raise NoAnswer("the service ended the stream of events") from None

    def record(self) -> list[Json]:
        """Every event with the whole state after it."""
        return self.room.get_list(f"/cases/{self.id}/audit")

    def attempts(self) -> list[Json]:
        """Every request that was decided, newest first, with the verdict of every interlock."""
        return self.room.get_list(f"/interlocks?case={self.id}")

    def carm_angles(self, planned_target: str) -> Json:
        """The C-arm's angles for a planned target, degrees."""
        return self.room.get(f"/cases/{self.id}/planned-targets/{planned_target}/carm-angles")

    def report(self, file: Path) -> Path:
        """Write the case's report, a PDF."""
        return self.room.download(f"/cases/{self.id}/report", file)

    def export(self, file: Path, *, pseudonymise: bool = False) -> Path:
        """Write everything that was recorded of the case, with its proof, to one file."""
        return self.room.download(f"/cases/{self.id}/export", file, pseudonymise=pseudonymise)

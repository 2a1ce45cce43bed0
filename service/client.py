"""The public Python client: the HTTP interface as a scripted user needs it, and nothing else of the service.

room = Coaxial("http://127.0.0.1:8700")
room.sign_in("surgeon", "password")
case = room.open_case({"patient_id": "P1", "study_uid": "1.2.3", "targets": [...]})
case.take_lease("start")
case.command("carm-position-confirmed")
plan = case.plan("approach", base_from_goal={"translation_mm": [...], "rotation_vector_deg": [...]})
with case.hold(case.approve(plan, pin="1234")) as hold:
    print(hold.wait(60.0))
"""

import json
import time
from collections.abc import Callable, Iterator, Mapping
from typing import Any, Self
from uuid import uuid4

import httpx

from service.client_hold import Hold, HoldEnded
from service.client_refused import Refused

__all__ = ["Case", "Coaxial", "Hold", "HoldEnded", "Refused"]

Json = dict[str, Any]
_POLL_S = 0.05


class Coaxial:
    """One signed-in user of one room's service."""

    def __init__(self, url: str, timeout_s: float = 30.0) -> None:
        self._url = url.rstrip("/")
        self._http = httpx.Client(base_url=f"{self._url}/api", timeout=timeout_s, trust_env=False)
        self._token = ""

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections; the session stays."""
        self._http.close()

    def sign_in(self, name: str, password: str) -> Json:
        """A session of this user; further calls carry it."""
        answer = self.post("/session", {"name": name, "password": password})
        self._token = str(answer["token"])
        self._http.headers["Authorization"] = f"Bearer {self._token}"
        return answer

    def stop(self) -> Json:
        """Stop the arm, whatever the state of anything."""
        return self.post("/stop")

    def status(self) -> Json:
        """The room: service, arm, open case."""
        return self.get("/status")

    def begin_daily_check(self) -> Json:
        """Look at arm and devices; `passed` is None while the check waits for one image of the guide."""
        return self.post("/daily-check")

    def finish_daily_check(self, check_id: str, image_id: str) -> Json:
        """Hold the image against the arm: the result, recorded."""
        return self.post(f"/daily-check/{check_id}/image", {"image_id": image_id})

    def upload_device(self, kind: str, file: bytes) -> Json:
        """Store a device file: kind guide, carm, tcp or room."""
        return self._answer(self._http.post(f"/devices/{kind}", content=file)).json()  # type: ignore[no-any-return]  # JSON

    def upload_image(self, media_type: str, file: bytes) -> Json:
        """Store an image (application/dicom, image/png, image/tiff); its id, and whether it awaits a statement."""
        answer = self._http.post("/images", content=file, headers={"Content-Type": media_type})
        return self._answer(answer).json()  # type: ignore[no-any-return]  # JSON

    def open_case(self, case: Json) -> "Case":
        """Open a case: patient_id, study_uid, position, targets (name, entry_mm, target_mm), devices by kind."""
        answer = self.post("/cases", case, headers={"Idempotency-Key": uuid4().hex})
        return Case(self, str(answer["id"]))

    def case(self, case_id: str) -> "Case":
        """A case that exists already."""
        return Case(self, case_id)

    def image(self, image_id: str) -> Json:
        """What is known of a stored image."""
        return self.get(f"/images/{image_id}")

    def original(self, image_id: str) -> bytes:
        """An image's bytes as they arrived."""
        return self._answer(self._http.get(f"/images/{image_id}/original")).content

    def findings(self, image_id: str) -> bytes:
        """What was found in an image whose registration or verification was refused, as a PNG file."""
        return self._answer(self._http.get(f"/images/{image_id}/findings")).content

    def get(self, path: str) -> Json:
        """GET below /api; Refused for every error."""
        return self._answer(self._http.get(path)).json()  # type: ignore[no-any-return]  # JSON

    def get_list(self, path: str) -> list[Json]:
        """GET of a list below /api."""
        return self._answer(self._http.get(path)).json()  # type: ignore[no-any-return]  # JSON

    def post(self, path: str, body: Json | None = None, headers: Mapping[str, str] | None = None) -> Json:
        """POST below /api; Refused for every error."""
        return self._answer(self._http.post(path, json=body or {}, headers=headers)).json()  # type: ignore[no-any-return]  # JSON

    def stream(self, path: str, headers: Mapping[str, str]) -> Iterator[Json]:
        """Server-sent events below /api, as they come."""
        with self._http.stream("GET", path, headers=headers, timeout=None) as response:
            if response.is_error:
                response.read()
            self._answer(response)
            for line in response.iter_lines():
                if line.startswith("data:"):
                    yield json.loads(line[5:])

    def open_hold(self, path: str, on_ended: Callable[[HoldEnded], None]) -> Hold:
        """The held button below /api."""
        return Hold(f"{self._url.replace('http', 'ws', 1)}/api{path}", self._token, on_ended)

    @staticmethod
    def _answer(response: httpx.Response) -> httpx.Response:
        if response.is_error:
            raise Refused.from_body(response.status_code, response.content)
        return response


class Case:
    """One case, its version and lease as this client last saw them; a stale version is refused, never overwritten."""

    def __init__(self, room: Coaxial, case_id: str) -> None:
        self.room = room
        self.id = case_id
        self.version = 0
        self.control_token: int | None = None

    def status(self) -> Json:
        """The atomic status; its version is what the next command is decided on."""
        status = self.room.get(f"/cases/{self.id}/status")
        self.version = int(status["version"])
        return status

    def command(self, name: str, **body: Any) -> Json:
        """Send a command under a new Idempotency-Key, on the version last seen (read first, if none was)."""
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

    def hold(self, permit_id: str) -> Hold:
        """The held button of a permit."""
        token = "" if self.control_token is None else f"&control_token={self.control_token}"
        return self.room.open_hold(f"/cases/{self.id}/hold?permit={permit_id}{token}", self._moved)

    def _moved(self, ended: HoldEnded) -> None:
        self.version = max(self.version, ended.version)

    def stop(self) -> Json:
        """Stop the arm."""
        return self.room.stop()

    def emergency_access(self) -> Json:
        """Stop the arm and leave it to whoever stands at the pendant; the case is held."""
        return self.room.post(f"/cases/{self.id}/emergency-access")

    def wait_for(self, *states: str, timeout_s: float = 30.0) -> Json:
        """The status once the case is in one of these states; TimeoutError, naming the state it is in."""
        end_s = time.monotonic() + timeout_s
        while (status := self.status())["state"] not in states:
            if time.monotonic() > end_s:
                raise TimeoutError(f"case is {status['state']}, not {' or '.join(states)}, after {timeout_s} s")
            time.sleep(_POLL_S)
        return status

    def events(self, after: int = 0) -> Iterator[Json]:
        """Every event behind sequence `after`, then each new one as it happens."""
        return self.room.stream(f"/cases/{self.id}/events", {"Last-Event-ID": str(after)})

    def record(self) -> list[Json]:
        """Every event with the whole state after it."""
        return self.room.get_list(f"/cases/{self.id}/audit")

    def attempts(self) -> list[Json]:
        """Every request that was decided, newest first, with the verdict of every interlock."""
        return self.room.get_list(f"/interlocks?case={self.id}")

    def carm_angles(self, planned_target: str) -> Json:
        """The C-arm's angles for a planned target, degrees."""
        return self.room.get(f"/cases/{self.id}/planned-targets/{planned_target}/carm-angles")

"""The room's door as the demonstration uses it: what hands and eyes do in a real room."""

from dataclasses import dataclass
from typing import Any

import httpx

from simulator.demo.failure import DemoFailed

Json = dict[str, Any]
_TIMEOUT_S = 60.0  # an exposure renders an image and sends it before it answers


@dataclass(frozen=True, slots=True)
class PlannedPedicle:
    """A path planned in the patient's CT, patient coordinates (LPS), mm."""

    name: str
    entry_mm: tuple[float, float, float]
    target_mm: tuple[float, float, float]


@dataclass(frozen=True, slots=True)
class TrueError:
    """What the room knows of the guide's axis against the target."""

    angle_deg: float
    position_mm: float


class Door:
    """The room from outside; DemoFailed where it says no."""

    def __init__(self, url: str) -> None:
        self.url = url
        self._http = httpx.Client(base_url=url, timeout=_TIMEOUT_S, trust_env=False)

    def close(self) -> None:
        """Close the connections."""
        self._http.close()

    def room(self) -> Json:
        """Patient, study, and how everything stands."""
        return self._get("/room")

    def pedicles(self) -> list[PlannedPedicle]:
        """The planned paths, from the head down."""
        answer = self._get("/pedicles")
        return [
            PlannedPedicle(str(one["name"]), tuple(one["entry_mm"]), tuple(one["target_mm"]))
            for one in answer["pedicles"]
        ]

    def position_carm(self, primary_deg: float, secondary_deg: float, pedicle: str) -> None:
        """Turn the C-arm and centre it on a pedicle, as a radiographer would."""
        self._post("/carm/position", {"primary_deg": primary_deg, "secondary_deg": secondary_deg, "pedicle": pedicle})

    def expose(self) -> None:
        """Press the pedal: the image goes out by DICOM; DemoFailed if the receiver does not take it.

        The patient has breathed out, for two images of one who did not move must not differ by the breath.
        """
        sent = self._post("/expose", {"at_expiration": True})
        if not sent["accepted"]:
            raise DemoFailed("image_not_accepted", f"status {sent['status']}: {sent['detail']}")

    def pixel_of(self, pedicle: str) -> tuple[float, float]:
        """Where a surgeon sees the pedicle in the newest image, raw pixels."""
        u_px, v_px = self._get(f"/pedicles/{pedicle}/pixel")["pixel_px"]
        return float(u_px), float(v_px)

    def approach_to(self, pedicle: str) -> Json:
        """A pose by eye that brings the guide into the beam: translation_mm, rotation_vector_deg, base frame."""
        answer = self._get(f"/approach?pedicle={pedicle}")
        return {name: answer[name] for name in ("translation_mm", "rotation_vector_deg")}

    def true_error(self, pedicle: str) -> TrueError:
        """Of the guide where it is now."""
        answer = self._get(f"/truth/errors?pedicle={pedicle}")
        return TrueError(float(answer["angle_error_deg"]), float(answer["position_error_mm"]))

    def inject(self, fault: str) -> None:
        """Make something go wrong."""
        self._post(f"/faults/{fault}", {})

    def _get(self, path: str) -> Json:
        return self._answer(self._http.get(path))

    def _post(self, path: str, body: Json) -> Json:
        return self._answer(self._http.post(path, json=body))

    @staticmethod
    def _answer(response: httpx.Response) -> Json:
        if response.is_error:
            raise DemoFailed("room_refused", f"{response.request.url.path}: {response.status_code} {response.text}")
        answer: Json = response.json()
        return answer

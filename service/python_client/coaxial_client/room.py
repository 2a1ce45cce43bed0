"""A room's service as one signed-in user sees it."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Self
from uuid import uuid4

from coaxial_client.case import Case
from coaxial_client.transport import Json, Transport

_DOWNLOAD_QUIET_S = 300.0  # a large case is packed before its first byte comes


class Coaxial:
    """One user of one room's service; a context manager that closes the connections.

    Parameters
    ----------
    url : str
        As the service prints it: "http://127.0.0.1:8700", or https where a proxy in front of it ends TLS.
    timeout_s : float
        How long any one request may take before `NoAnswer` is raised.
    ca_file : Path, optional
        Certificates (PEM) of the hospital's own authority; without it those that the machine trusts.

    Raises
    ------
    ValueError
        A CA file for an address without TLS.
    """

    def __init__(self, url: str, timeout_s: float = 30.0, ca_file: Path | None = None) -> None:
        self._transport = Transport(url, timeout_s, ca_file)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the connections; the session stays until `sign_out`, or until it expires."""
        self._transport.close()

    def sign_in(self, name: str, password: str | None = None, *, pin: str | None = None) -> Json:
        """A session of this user, by password or, where the room allows it, by PIN; further calls carry it."""
        proof = {"password": password, "pin": pin}
        answer = self.post("/session", {"name": name} | {kind: one for kind, one in proof.items() if one is not None})
        self._transport.token = str(answer["token"])
        return answer

    def sign_out(self) -> None:
        """End the session: its token is good for nothing from now on."""
        self._transport.request("DELETE", "/session")
        self._transport.token = ""

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
        return self._json("POST", f"/devices/{kind}", content=file)

    def upload_image(self, media_type: str, file: bytes) -> Json:
        """Store an image (application/dicom, image/png, image/tiff); its id, and whether it awaits a statement."""
        return self._json("POST", "/images", content=file, headers={"Content-Type": media_type})

    def open_case(self, case: Json) -> Case:
        """Open a case: patient_id, study_uid, position, targets (name, entry_mm, target_mm), devices by kind."""
        answer = self.post("/cases", case, headers={"Idempotency-Key": uuid4().hex})
        return self.case(str(answer["id"]))

    def case(self, case_id: str) -> Case:
        """A case that exists already."""
        return Case(self, self._transport, case_id)

    def image(self, image_id: str) -> Json:
        """What is known of a stored image."""
        return self.get(f"/images/{image_id}")

    def original(self, image_id: str) -> bytes:
        """An image's bytes as they arrived."""
        return self._transport.request("GET", f"/images/{image_id}/original").content

    def findings(self, image_id: str) -> bytes:
        """What was found in an image whose registration or verification was refused, as a PNG file."""
        return self._transport.request("GET", f"/images/{image_id}/findings").content

    def export_audit(self, file: Path, form: str = "jsonl", **wanted: Any) -> Path:
        """Write the ledger's entries to a file: form jsonl, csv, dicom or fhir; wanted: case, actor, action, ..."""
        return self.download("/audit/export", file, format=form, **wanted)

    def download(self, path: str, file: Path, **query: Any) -> Path:
        """Write an answer below /api to a file as it comes; the file appears whole or not at all."""
        return self._transport.download(path, query, file, _DOWNLOAD_QUIET_S)

    def get(self, path: str) -> Json:
        """GET of an object below /api."""
        return self._json("GET", path)

    def get_list(self, path: str) -> list[Json]:
        """GET of a list below /api."""
        answer: list[Json] = self._transport.request("GET", path).json()
        return answer

    def post(self, path: str, body: Json | None = None, headers: Mapping[str, str] | None = None) -> Json:
        """POST below /api, sent once."""
        return self._json("POST", path, json=body or {}, headers=headers)

    def _json(self, method: str, path: str, **content: Any) -> Json:
        answer: Json = self._transport.request(method, path, **content).json()
        return answer

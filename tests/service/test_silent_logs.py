"""What people type and who lies on the table never reaches a log, whatever goes wrong with it."""

import pytest

from service.auth.permissions import Role
from tests.service.conftest import PASSWORD, PIN

_SECRET = "hunter2-and-more"
_PATIENT = "Doe-4711"
_CASE = {
    "patient_id": _PATIENT,
    "study_uid": "1.2.3",
    "targets": [{"name": "L4 left", "entry_mm": [0.0, 0.0, 0.0], "target_mm": [0.0, 40.0, 0.0]}],
}


@pytest.mark.hazard("H27")
def test_neither_secrets_nor_patients_are_logged(running, make_xray, capfd):
    key = {"Idempotency-Key": "k"}
    with running.client(None) as stranger:
        stranger.post("/session", json={"name": "surgeon", "password": _SECRET})
        stranger.post("/session", json={"name": _SECRET, "pin": _SECRET})
        stranger.post("/session", content=f'{{"name": "surgeon", "password": "{_SECRET}"')
        token = stranger.post("/session", json={"name": "surgeon", "password": PASSWORD}).json()["token"]
        stranger.post("/session/lock")
        stranger.post("/session/unlock", json={"pin": "9753"})
        stranger.post("/session/unlock", json={"pin": PIN})
    with running.client(Role.SURGEON) as surgeon:
        surgeon.get(f"/cases/{_PATIENT}/status")
        surgeon.post(f"/patients/{_PATIENT}")
        surgeon.post("/cases", json=_CASE | {"study_uid": _PATIENT}, headers=key)
        surgeon.post("/cases", json=_CASE, headers=key)
        image = make_xray(PatientID=_PATIENT, PatientName="Doe^Jane")
        surgeon.post("/images", content=image, headers={"Content-Type": "application/dicom"})
    logged = "".join(capfd.readouterr())
    assert "request_refused" in logged, "nothing was logged: this proves nothing"
    for told in (_SECRET, PASSWORD, PIN, "9753", token, *running.tokens.values(), _PATIENT, "Doe^Jane"):
        assert told not in logged

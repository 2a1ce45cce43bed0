"""A record of many finished cases, without what the charts do not read."""

from collections.abc import Callable, Sequence

import pytest

from service.auth.permissions import Role
from service.cases import store
from service.cases.records import ArtefactKind, NewArtefact, NewCase, NewEvent
from service.devices.store import add_device
from service.images.dicom_header import read_header
from service.images.store import add_image
from service.settings import DicomSettings
from workflow.triggers import Trigger

NAME, PATIENT = "Doe^Jane", "PATIENT-1"


class Recorder:
    """Writes finished cases of one target each into a database."""

    def __init__(self, connection, user_id: str, image_id: str, devices: dict[str, str]) -> None:
        self._connection, self._user_id, self._image_id, self._devices = connection, user_id, image_id, devices

    def record(self, number: int, error_mm: float, *, changed: dict[str, str] | None = None) -> None:
        """A case whose target was first verified with this error and then corrected; three exposures."""
        case_id = f"case-{number:03d}"
        new = NewCase(case_id, "room-1", PATIENT, "1.2.3", self._user_id, "0" * 64, self._devices, {})
        store.open_case(self._connection, new, self._event("case_opened"))
        self._append(case_id, Trigger.CARM_POSITION_CONFIRMED)
        if changed:
            self._append(case_id, Trigger.DEVICE_CHANGED, devices=changed)
        self._append(case_id, Trigger.IMAGE_ARRIVED)
        self._append(case_id, Trigger.REGISTRATION_COMPLETED, artefact=self._registration(f"r-{number}", 0.1))
        self._append(case_id, Trigger.TARGET_CONFIRMED)
        for name, error in (("first", error_mm), ("corrected", 0.001)):
            self._append(case_id, Trigger.IMAGE_ARRIVED)
            self._append(case_id, Trigger.VERIFICATION_FAILED, artefact=self._evaluation(f"{name}-{number}", error))
            self._append(case_id, Trigger.CORRECTION_REQUESTED)
        self._append(case_id, Trigger.TARGET_DONE, placed=True)
        self._append(case_id, Trigger.CASE_CLOSED, state="closed")

    def _append(self, case_id: str, trigger: str, artefact=None, state: str = "case_open", **data) -> None:
        made = () if artefact is None else (artefact,)
        store.append(
            self._connection, case_id, self._event(trigger, state, data), expected_version=None, artefacts=made
        )

    @staticmethod
    def _event(trigger: str, state: str = "case_open", data: dict | None = None) -> NewEvent:
        return NewEvent(trigger, None, state, {}, data or {})

    def _evaluation(self, name: str, error_mm: float) -> NewArtefact:
        content = {"contour": {"position_error_mm": error_mm, "angle_error_deg": 0.02}}
        return NewArtefact(ArtefactKind.EVALUATION, name, (), content, {"image_id": self._image_id})

    def _registration(self, name: str, residual_px: float) -> NewArtefact:
        shift_px = {"degree": 0, "coefficients_px": [[3.0, 4.0]], "balls": 400, "rms_px": 0.05, "pixel_size_mm": 0.3}
        distortion = shift_px | {"centre_px": [511.5, 511.5], "half_size_px": 512.0}
        content = {"residual_rms_px": residual_px, "distortion": distortion}
        return NewArtefact(ArtefactKind.REGISTRATION, name, (), content, {"image_id": self._image_id})


@pytest.fixture
def record_cases(database, users, device_files, make_xray) -> Callable[[Sequence[float]], None]:
    """Records a case for each position error, in this order."""

    def record(errors_mm: Sequence[float]) -> None:
        user_id = users.add("anna", Role.SURGEON, "correct horse", "2468").id
        xray = make_xray(PatientID=PATIENT, PatientName=NAME)
        with database.write() as connection:
            image_id = add_image(connection, xray, *read_header(xray, DicomSettings()), {}).id
            devices = {
                kind: add_device(connection, kind, file.encode(), user_id).id for kind, file in device_files.items()
            }
        for number, error_mm in enumerate(errors_mm):
            with database.write() as connection:
                changed = {"tcp": devices["tcp"]} if number == 0 else None
                Recorder(connection, user_id, image_id, devices).record(number, error_mm, changed=changed)

    return record

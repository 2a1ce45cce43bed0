"""Images as small as the service takes them, and image work whose outcome a sequence chooses."""

import asyncio
import base64
from collections import deque
from dataclasses import dataclass
from io import BytesIO
from typing import Any

import numpy as np
from pydicom.dataset import Dataset, FileMetaDataset
from pydicom.uid import ExplicitVRLittleEndian, XRayAngiographicImageStorage, generate_uid

from service.errors import ErrorCode, ServiceError
from service.ledger.speaker import SPEAKER

Json = dict[str, Any]
_BY_ITSELF = SPEAKER.get()  # who speaks where nobody asked
_SIDE_PX = 64  # the least that the receiver takes
_PREDICTED = {"angle_deg": 0.03, "position_mm": 0.06, "depth_mm": 80.0}
_REFUSED = {"status": "refused", "reason": {"code": "ring_missing", "message": "scripted", "measured": 0, "limit": 1}}


@dataclass(frozen=True, slots=True)
class Sender:
    """Whose images, by which study."""

    patient_id: str
    study_uid: str


def xa_image(sender: Sender, pixels: np.ndarray, second: int) -> bytes:
    """An XA image, taken `second` seconds after the C-arm's own midnight of its first day."""
    dataset = Dataset()
    dataset.file_meta = FileMetaDataset()
    dataset.file_meta.TransferSyntaxUID = ExplicitVRLittleEndian
    dataset.SOPClassUID = dataset.file_meta.MediaStorageSOPClassUID = XRayAngiographicImageStorage
    dataset.SOPInstanceUID = dataset.file_meta.MediaStorageSOPInstanceUID = generate_uid()
    dataset.PatientID, dataset.PatientName, dataset.StudyInstanceUID = sender.patient_id, "X", sender.study_uid
    dataset.Modality, dataset.PhotometricInterpretation, dataset.StationName = "XA", "MONOCHROME2", "CARM"
    dataset.Rows, dataset.Columns, dataset.SamplesPerPixel, dataset.PixelRepresentation = _SIDE_PX, _SIDE_PX, 1, 0
    dataset.BitsAllocated = dataset.BitsStored = 16
    dataset.HighBit = 15
    days, rest = divmod(second, 86400)
    dataset.AcquisitionDate = str(20200101 + days)
    dataset.AcquisitionTime = f"{rest // 3600:02}{rest // 60 % 60:02}{rest % 60:02}"
    dataset.PixelData = pixels.tobytes()
    file = BytesIO()
    dataset.save_as(file, enforce_file_format=True)
    return file.getvalue()


def pixels_of(number: int) -> np.ndarray:
    """Pixels (64, 64) that no other number has."""
    pixels = np.zeros((_SIDE_PX, _SIDE_PX), np.uint16)
    pixels.flat[:4] = [number >> shift & 0xFFFF for shift in (48, 32, 16, 0)]
    return pixels


def _registration(*, sound: bool) -> Json:
    return {
        "status": "registered",
        "image": {"rows": _SIDE_PX, "columns": _SIDE_PX},
        "carm": {"plate": None, "source_to_image_mm": 1000.0, "field_of_view_mm": 360.0},
        "bead_px": [1.0, 1.0] if sound else None,  # without it nothing proves the handedness
        "distortion": {"balls": 0},
        "fiducials_px": {str(number): [1.0, 1.0] for number in range(12)},
        "intrinsics_px": {"alpha_x": 1000.0 * _SIDE_PX / 360.0},
        "residual_rms_px": 0.1,
        "predicted_error_95": _PREDICTED,
        "elapsed_ms": 1.0,
    }


_TARGETING = {
    "status": "targeted",
    "target_raw_px": [30.0, 30.0],
    "guide_from_goal": [[1, 0, 0, 1.0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
    "predicted_error_95": _PREDICTED,
    "detectable_motion": None,
}
_ECHO = {
    "status": "drawn",
    "raw_px": [30.0, 30.0],
    "corrected_px": [30.0, 30.0],
    "crop_png_base64": base64.b64encode(b"-").decode(),
    "crop_origin_px": [0, 0],
    "crop_scale": 1,
}


def _evaluation(outcome: str) -> Json:
    degrees = 2.0 if outcome == "exceeded" else 0.2
    return {
        "status": "evaluated",
        "contour": {"angle_error_deg": degrees, "position_error_mm": 0.3, "predicted_error_95": _PREDICTED},
        "paper": {"angle_error_deg": degrees, "position_error_mm": 0.3},
        "difference": {"angle_error_deg": 0.01, "position_error_mm": 0.2 if outcome == "disagree" else 0.01},
        "difference_limit": {"angle_error_deg": 0.04, "position_error_mm": 0.1},
        "agree": outcome != "disagree",
        "motion_agreement": {"chi_square": 40.0 if outcome == "view_moved" else 6.0, "limit": 18.548},
        "anatomy_shift": {
            "measured": outcome != "unmeasured",
            "across_mm": 0.9 if outcome == "patient_shifted" else 0.1,
            "along_mm": 0.2,
        },
        "registration": _registration(sound=True),
    }


class ScriptedVision:
    """In place of the vision worker: work of the procedure's own waits for `finish`, a person's is answered at once."""

    def __init__(self, _settings: object = None) -> None:
        self.pid = self.why_down = None
        self.found_again = True  # the guide, in an image that is to be reused
        self._waiting: deque[tuple[asyncio.AbstractEventLoop, asyncio.Future[str]]] = deque()

    async def start(self) -> None:
        """Nothing to start."""

    async def close(self) -> None:
        """Nothing to end."""

    def finish(self, outcome: str) -> None:
        """The work under way ends like this; from any thread."""
        loop, waiting = self._waiting.popleft()
        loop.call_soon_threadsafe(waiting.set_result, outcome)

    @property
    def is_at_work(self) -> bool:
        """Whether some of the procedure's work waits to be finished."""
        return bool(self._waiting)

    async def register(self, _image: bytes, _guide: bytes, _carm: bytes, _proved: bool = False) -> Json:
        """A registration: `sound`, `unsound`, `refused` or `crashed`."""
        if SPEAKER.get() != _BY_ITSELF:
            return _registration(sound=True) if self.found_again else _REFUSED
        outcome = await self._outcome()
        return _REFUSED if outcome == "refused" else _registration(sound=outcome == "sound")

    async def evaluate(self, *_inputs: object) -> Json:
        """An evaluation."""
        outcome = await self._outcome()
        return _REFUSED if outcome == "refused" else _evaluation(outcome)

    async def target(self, *_inputs: object) -> Json:
        """Where the guide must go: a millimetre aside."""
        return _TARGETING

    async def run(self, job: str, *_arguments: object) -> Json:
        """A picked point drawn back; nothing else is asked."""
        if job != "echo":
            raise ValueError(f"no scripted answer for {job}")
        return _ECHO

    async def _outcome(self) -> str:
        loop = asyncio.get_running_loop()
        waiting: asyncio.Future[str] = loop.create_future()
        self._waiting.append((loop, waiting))
        outcome = await waiting
        if outcome == "crashed":
            raise ServiceError(ErrorCode.VISION_CRASHED, "scripted")
        return outcome

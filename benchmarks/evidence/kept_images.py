"""A C-arm with two images, rendered once: the guide a millimetre before its goal, and at its goal."""

from io import BytesIO

import numpy as np
from pydicom.dataset import Dataset

from service.vision_jobs import register, target
from tests.system.carm import CArm
from tests.system.conftest import DEVICES
from tests.system.service_process import Service
from tests.system.walk import Walk, tilted_guide

_BEFORE_MM = 1.0
_NEAR_MM = 0.2  # from registration to registration the goal differs by some hundredths
_DEPTH_MM = 80.0  # as the service takes by itself
_ERRORS = {"arm_sd_deg": 0.02, "arm_sd_mm": 2.0, "tcp_sd_deg": 0.02, "tcp_sd_mm": 0.1}  # they move no goal


class KeptImages(CArm):
    """Sends one of both for each exposure, with pixels that no image before it had."""

    def __init__(self, service: Service, patient_id: str, study_uid: str) -> None:
        super().__init__(service, patient_id, study_uid)
        source_from_goal = self._source_from_goal()
        shift = np.eye(4)
        shift[0, 3] = _BEFORE_MM
        self.source_from_start = source_from_goal @ shift
        self._kept = [(pose, self.image(pose)) for pose in (self.source_from_start, source_from_goal)]

    def expose(self, source_from_guide: np.ndarray, **elements: object) -> int | None:
        """The kept image of the guide there; ValueError where there is none."""
        (off_mm, which) = min((_apart_mm(pose, source_from_guide), at) for at, (pose, _) in enumerate(self._kept))
        if off_mm > _NEAR_MM or elements:
            raise ValueError(f"no image is kept of a guide {off_mm:.2f} mm from where it was seen")
        image = self.sent_again(self._kept[which][1])
        image.PixelData = self._exposures.to_bytes(4, "little") + image.PixelData[4:]
        return self.send(image)

    def _source_from_goal(self) -> np.ndarray:
        """Where the guide is to go for the walk's target, as seen from beside it."""
        seen = tilted_guide()
        guide, carm = DEVICES["guide"], DEVICES["carm"]
        registration = register(_written(self.image(seen)), guide, carm)
        goal = target(registration, Walk.target_px, _DEPTH_MM, _ERRORS)
        return seen @ np.array(goal["guide_from_goal"])


def _apart_mm(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.linalg.norm(one[:3, 3] - other[:3, 3]))


def _written(image: Dataset) -> bytes:
    file = BytesIO()
    image.save_as(file, enforce_file_format=True)
    return file.getvalue()

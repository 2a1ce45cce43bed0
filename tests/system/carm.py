"""A C-arm without a room: renders a guide at a pose that the test says, and sends it."""

import math
from datetime import datetime, timedelta

import numpy as np
from pydicom.dataset import Dataset
from pydicom.uid import generate_uid

from simulator.carm.anatomy import Body
from simulator.carm.camera import Camera
from simulator.carm.dicom import Frame, Worklist, xa_image
from simulator.carm.geometry import Angles
from simulator.carm.guide import GuideShape
from simulator.carm.render import render
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from simulator.carm.sending import Destination, Sent, send
from simulator.carm.solids import Shape, Solid
from tests.system.service_process import Service

_CAMERA = Camera(source_to_image_mm=1000.0, pixel_mm=360.0 / 1024, principal_u_px=514.0, principal_v_px=508.0)
# Bone about the middle of the image, 590 mm from the source: what the check for a moved patient holds on to.
_BONES = tuple(
    Solid(Shape.ELLIPSOID, (x, y, 0.0), (9.0, 6.0, 12.0), 0.03)
    for x, y in ((-38.0, -22.0), (-14.0, 31.0), (4.0, -29.0), (21.0, 12.0), (44.0, -8.0), (-33.0, 9.0), (52.0, 34.0))
)
_BODY = Body(bone=_BONES, soft=(), bone_textures=(), soft_textures=())
_FIRST_AT = datetime(2026, 1, 5, 12)  # by its own clock


class CArm:
    """Renders a guide at a pose and sends it as a C-arm would, by its own clock."""

    def __init__(self, service: Service, patient_id: str, study_uid: str) -> None:
        self._service = service
        self._worklist = Worklist.of(patient_id, "Doe^Jane", study_uid)
        self._exposures = 0
        self.patient_mm = np.array([0.0, 0.0, 590.0])  # place in the source frame
        self.shape = GuideShape()

    def expose(self, source_from_guide: np.ndarray, **elements: object) -> int | None:
        """Send an image of the guide; the status of the C-STORE. `elements` replace those of the data set."""
        return self.send(self.image(source_from_guide, **elements))

    def image(self, source_from_guide: np.ndarray, **elements: object) -> Dataset:
        """An XA image; each is a second later than the one before."""
        frame = self._frame(source_from_guide)
        dataset = xa_image(frame, self._worklist)
        for name, value in elements.items():
            setattr(dataset, name, value)
        return dataset

    def sent_again(self, image: Dataset) -> Dataset:
        """The same pixels as a new image of now."""
        image.SOPInstanceUID = image.file_meta.MediaStorageSOPInstanceUID = generate_uid()
        image.AcquisitionTime = self._now().strftime("%H%M%S.%f")
        return image

    def send(self, dataset: Dataset) -> int | None:
        """C-STORE."""
        sent: Sent = send(dataset, self._destination())
        return sent.status

    def _destination(self) -> Destination:
        with self._service.sign_in() as client:
            return Destination("127.0.0.1", client.status()["dicom_port"], "COAXIAL")

    def _now(self) -> datetime:
        self._exposures += 1
        return _FIRST_AT + timedelta(seconds=self._exposures)

    def _frame(self, source_from_guide: np.ndarray) -> Frame:
        at = self._now()
        guides = (PlacedGuide(self.shape, source_from_guide),)
        patient = np.eye(4)
        patient[:3, 3] = self.patient_mm
        scene = Scene(
            _CAMERA,
            guides,
            (500.0, 500.0),
            intensifier=False,
            body=_BODY,
            source_from_patient=patient,
            exposure=Exposure(bits=16),
        )
        pixels = render(scene, seed=self._exposures).pixels
        return Frame(
            pixels=np.asarray(pixels, dtype=np.uint16),
            angles=Angles(math.pi, 0.0),
            source_to_image_mm=1000.0,
            source_to_patient_mm=700.0,
            pixel_mm=_CAMERA.pixel_mm,
            field_of_view_mm=360.0,
            round_field=False,
            number=self._exposures,
            at=at,
            dose_share=1.0,
        )

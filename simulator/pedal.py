"""The exposure pedal: one image of the room as it is now, out by DICOM."""

import threading
from dataclasses import dataclass, replace
from datetime import datetime, timedelta

import cv2
import numpy as np
from numpy.typing import NDArray
from pydicom.dataset import Dataset
from pydicom.uid import generate_uid

from simulator.carm.dicom import Frame, Worklist, xa_image
from simulator.carm.geometry import SOURCE_TO_ISOCENTRE_MM
from simulator.carm.render import render
from simulator.carm.scene import Scene
from simulator.carm.sending import Destination, Sent, send, send_truncated
from simulator.faults import FOREIGN_PATIENT_ID, FOREIGN_PATIENT_NAME, RoomFault
from simulator.room import Room

Array = NDArray[np.float64]


class NoImageError(Exception):
    """Nothing has been exposed yet."""


@dataclass(frozen=True, slots=True, eq=False)
class Taken:
    """An image that was taken: what it shows, and what was sent."""

    scene: Scene
    dataset: Dataset
    mirrored: bool
    scale: float  # stored pixels a rendered pixel


class Pedal:
    """Exposes and sends; keeps the newest image."""

    def __init__(self, room: Room, destination: Destination, worklist: Worklist) -> None:
        self.room, self.destination, self.worklist = room, destination, worklist
        self.exposures = 0
        self._newest: Taken | None = None
        self._lock = threading.Lock()

    @property
    def newest(self) -> Taken:
        """The image taken last; NoImageError before the first."""
        if self._newest is None:
            raise NoImageError("nothing has been exposed yet")
        return self._newest

    def press(self, worklist: Worklist | None = None) -> tuple[Taken, Sent]:
        """Take an image and send it, for the C-arm's worklist or another; a fault may send the newest again."""
        with self._lock:
            faults = self.room.faults
            if RoomFault.RESEND_OLD_IMAGE not in faults or self._newest is None:
                self._newest = self._expose(faults, worklist or self.worklist)
            broken = RoomFault.TRUNCATED_ASSOCIATION in faults
            sent = (send_truncated if broken else send)(self._newest.dataset, self.destination)
            return self._newest, sent

    def pixel_of(self, name: str) -> tuple[float, float]:
        """Raw pixel of the newest image that shows a pedicle's target; KeyError for an unknown one."""
        taken = self.newest
        scene, pose = taken.scene, taken.scene.source_from_patient
        target = pose[:3, :3] @ self.room.pedicle(name).target_in_patient + pose[:3, 3]
        u, v = scene.distortion.raw_from_ideal(scene.camera.project(target))
        if taken.mirrored:
            u = scene.camera.columns - 1 - u
        middle = (taken.scale - 1.0) / 2.0  # pixel centres: a stored pixel's centre lies between the rendered ones
        return float(u * taken.scale + middle), float(v * taken.scale + middle)

    def _expose(self, faults: frozenset[RoomFault], worklist: Worklist) -> Taken:
        self.exposures += 1
        scene = self.room.scene()
        pixels = np.asarray(render(scene, seed=self.room.truth.seed + self.exposures).pixels, dtype=np.uint16)
        mirrored, scale = RoomFault.MIRRORED in faults, 0.5 if RoomFault.HALF_SCALE in faults else 1.0
        if mirrored:
            pixels = np.ascontiguousarray(pixels[:, ::-1])
        if scale != 1.0:
            pixels = np.asarray(cv2.resize(pixels, None, fx=scale, fy=scale, interpolation=cv2.INTER_AREA))
        return Taken(scene, xa_image(self._frame(pixels), _wrong(worklist, faults)), mirrored, scale)

    def _frame(self, pixels: NDArray[np.uint16]) -> Frame:
        nominal, truth = self.room.nominal, self.room.truth
        return Frame(
            pixels=pixels,
            angles=self.room.stand.angles,
            source_to_image_mm=nominal.source_to_image_mm,
            source_to_patient_mm=SOURCE_TO_ISOCENTRE_MM,
            pixel_mm=nominal.field_of_view_mm / pixels.shape[1],
            field_of_view_mm=nominal.field_of_view_mm,
            round_field=nominal.intensifier,
            number=self.exposures,
            at=datetime.now() + timedelta(seconds=truth.carm.clock_offset_s),
            dose_share=self.room.dose_share,
        )


def _wrong(worklist: Worklist, faults: frozenset[RoomFault]) -> Worklist:
    """The entry under which an image really goes out."""
    if RoomFault.FOREIGN_PATIENT in faults:
        worklist = replace(worklist, patient_id=FOREIGN_PATIENT_ID, patient_name=FOREIGN_PATIENT_NAME)
    if RoomFault.WRONG_STUDY in faults:
        worklist = replace(worklist, study_uid=str(generate_uid(prefix=None)))
    return worklist

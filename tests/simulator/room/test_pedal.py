"""Exposures as they arrive at a DICOM store."""

from datetime import datetime, timedelta

import numpy as np
import pytest
from pydicom.uid import XRayAngiographicImageStorage

from simulator.carm.geometry import Angles
from simulator.carm.sending import Destination
from simulator.faults import FOREIGN_PATIENT_ID, RoomFault
from simulator.pedal import NoImageError, Pedal
from simulator.room import Room


def _moment(image) -> datetime:
    return datetime.strptime(image.AcquisitionDate + image.AcquisitionTime, "%Y%m%d%H%M%S.%f")


def test_image_arrives_whole_with_patient_angles_and_distances(pedal: Pedal, room: Room, receiver) -> None:
    room.position(Angles(np.deg2rad(165.9), np.deg2rad(5.8)), "L4-left")
    taken, sent = pedal.press()
    assert (sent.accepted, sent.status) == (True, 0)
    (image,) = receiver.images
    assert image.SOPClassUID == XRayAngiographicImageStorage
    assert image.SOPInstanceUID == taken.dataset.SOPInstanceUID
    assert (image.PatientID, image.StudyInstanceUID, image.Modality) == ("P1", "1.2.3", "XA")
    assert (float(image.PositionerPrimaryAngle), float(image.PositionerSecondaryAngle)) == (165.9, 5.8)
    assert float(image.DistanceSourceToDetector) == 1000.0  # nominal: the truth is 14 mm off
    assert [float(spacing) for spacing in image.ImagerPixelSpacing] == pytest.approx([0.351562] * 2)
    assert (image.Rows, image.Columns, image.BitsStored) == (1024, 1024, 16)
    assert image.PhotometricInterpretation == "MONOCHROME2"
    assert len(image.PixelData) == 2 * 1024 * 1024
    assert float(image.ImageAndFluoroscopyAreaDoseProduct) > 0.0


def test_carm_clock_is_minutes_off_and_goes_on(pedal: Pedal, room: Room, receiver) -> None:
    pedal.press()
    pedal.press()
    first, second = (_moment(image) for image in receiver.images)
    offset_s = (second - datetime.now()) / timedelta(seconds=1)
    assert offset_s == pytest.approx(room.truth.carm.clock_offset_s, abs=20.0)
    assert second > first
    assert receiver.images[0].SOPInstanceUID != receiver.images[1].SOPInstanceUID
    assert receiver.images[0].SeriesInstanceUID == receiver.images[1].SeriesInstanceUID


def test_resent_image_is_the_same_to_the_byte(pedal: Pedal, room: Room, receiver) -> None:
    pedal.press()
    room.inject(RoomFault.RESEND_OLD_IMAGE)
    pedal.press()
    first, second = receiver.images
    assert first.SOPInstanceUID == second.SOPInstanceUID
    assert first.PixelData == second.PixelData
    assert pedal.exposures == 1


@pytest.mark.parametrize(
    ("fault", "key"), [(RoomFault.FOREIGN_PATIENT, "PatientID"), (RoomFault.WRONG_STUDY, "StudyInstanceUID")]
)
def test_wrong_worklist_entry_goes_out_until_it_is_put_right(pedal: Pedal, room: Room, receiver, fault, key) -> None:
    room.inject(fault)
    pedal.press()
    room.clear(fault)
    pedal.press()
    wrong, right = (str(image[key].value) for image in receiver.images)
    assert right == {"PatientID": "P1", "StudyInstanceUID": "1.2.3"}[key]
    assert wrong != right
    assert fault is not RoomFault.FOREIGN_PATIENT or wrong == FOREIGN_PATIENT_ID


def _coarse(image) -> np.ndarray:
    """Means over blocks, in which the noise does not count."""
    pixels = np.frombuffer(image.PixelData, "<u2").reshape(1024, 1024)
    return pixels.reshape(64, 16, 64, 16).mean(axis=(1, 3))


def test_mirrored_image_is_flipped_and_the_pixel_follows(pedal: Pedal, room: Room, receiver) -> None:
    pedal.press()
    room.inject(RoomFault.MIRRORED)
    taken, _ = pedal.press()
    plain, flipped = (_coarse(image) for image in receiver.images)
    np.testing.assert_allclose(flipped, plain[:, ::-1], atol=600.0)  # of 65535: noise of 256 pixels
    mirrored = pedal.pixel_of("L3-left")
    scene = taken.scene
    pose = scene.source_from_patient
    target = pose[:3, :3] @ room.pedicle("L3-left").target_in_patient + pose[:3, 3]
    u, v = scene.distortion.raw_from_ideal(scene.camera.project(target))
    assert mirrored == pytest.approx((1023.0 - u, v))


def test_half_scale_image_has_half_the_rows_and_the_pixel_follows(pedal: Pedal, room: Room, receiver) -> None:
    room.inject(RoomFault.HALF_SCALE)
    pedal.press()
    half = pedal.pixel_of("L3-left")
    assert (receiver.images[0].Rows, receiver.images[0].Columns) == (512, 512)
    room.clear()
    pedal.press()
    assert half == pytest.approx([(whole - 0.5) / 2.0 for whole in pedal.pixel_of("L3-left")])


def test_broken_association_delivers_nothing(pedal: Pedal, room: Room, receiver) -> None:
    room.inject(RoomFault.TRUNCATED_ASSOCIATION)
    _, sent = pedal.press()
    assert not sent.accepted
    assert receiver.images == []
    room.clear()
    assert pedal.press()[1].accepted


# The library forgets the socket that nobody answered; its finalizer warns.
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")
def test_absent_receiver_is_told_not_raised(room: Room, pedal: Pedal) -> None:
    pedal.destination = Destination("127.0.0.1", 1, "NOBODY")
    _, sent = pedal.press()
    assert (sent.accepted, sent.status) == (False, None)
    assert "NOBODY" in sent.detail


def test_no_pixel_before_the_first_image(pedal: Pedal) -> None:
    with pytest.raises(NoImageError):
        pedal.pixel_of("L3-left")

"""What a case that is over leaves to the archive: images with what was found, errors and poses, the report."""

import asyncio
import base64
from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO

from pydicom import Dataset, dcmread
from sqlalchemy.engine import Connection

from service.cases import store
from service.cases.records import ArtefactKind, StoredCase
from service.cases.verifications import Verification, verifications_of
from service.conductor.device_set import DeviceSet, devices_of
from service.images.store import StoredImage, list_images, original_bytes, purpose_of
from service.pacs.annotated_image import annotated_image
from service.pacs.derived import DerivedObject, ObjectKind, device_uid, identity_of, place_of
from service.pacs.encapsulated_report import encapsulated_report
from service.pacs.structured_report import structured_report
from service.parts import Parts
from service.report.making import make_report
from workflow.decisions import ImageUse

_DEPTH_MM = 80.0  # where an image shows no target, only the registration is drawn
_IN_THE_CHAIN = (ImageUse.REGISTRATION, ImageUse.VERIFICATION)


@dataclass(frozen=True, slots=True, eq=False)
class OverCase:
    """All of a case that its objects are made of."""

    case: StoredCase
    identity: Dataset
    devices: DeviceSet
    images: list[tuple[StoredImage, bytes]]
    nudged: frozenset[str]  # images whose handedness a nudge had proved
    verifications: list[Verification]


async def objects_for(parts: Parts, case_id: str) -> list[DerivedObject]:
    """The objects of a case; each picture is drawn by the image worker."""
    over = await asyncio.to_thread(_read, parts, case_id)
    pictures = [await _annotated(parts, over, number) for number in range(len(over.images))]
    reports = await asyncio.to_thread(_reports, over)
    pdf = await make_report(parts.database, parts.vision, case_id)
    report = encapsulated_report(over.identity, place_of(case_id, ObjectKind.REPORT), pdf)
    return [*(one for one in pictures if one is not None), *reports, report]


def _read(parts: Parts, case_id: str) -> OverCase:
    with parts.database.read() as connection:
        case = store.read_case(connection, case_id)
        chain = [image for image in reversed(list_images(connection, case_id)) if _entered_chain(connection, image)]
        return OverCase(
            case,
            identity_of(connection, case),
            devices_of(connection, case_id),
            [(image, original_bytes(connection, image.id)) for image in chain],
            frozenset(_nudged(connection, case_id)),
            verifications_of(connection, case_id),
        )


def _entered_chain(connection: Connection, image: StoredImage) -> bool:
    purpose = purpose_of(connection, image.id)
    return purpose is not None and purpose.purpose in _IN_THE_CHAIN


def _nudged(connection: Connection, case_id: str) -> Iterator[str]:
    for one in store.artefacts_of(connection, ArtefactKind.REGISTRATION, case_id):
        if one.content.get("handedness_by") == "nudge":
            yield str(one.columns["image_id"])


async def _annotated(parts: Parts, over: OverCase, number: int) -> DerivedObject | None:
    """One image with what was found in it, and the target that it verified; None where it cannot be decoded."""
    image, content = over.images[number]
    verified = next((one for one in over.verifications if one.image_id == image.id), None)
    raw_px = verified.target["raw_px"] if verified else None
    depth_mm = verified.target["depth_mm"] if verified else _DEPTH_MM
    devices, nudged = over.devices, image.id in over.nudged
    drawn = await parts.vision.run("annotate", content, devices.guide, devices.carm, raw_px, depth_mm, nudged)
    if drawn["status"] == "refused":
        return None
    picture = base64.b64decode(drawn["picture_png_base64"])
    place = place_of(over.case.id, ObjectKind.ANNOTATED_IMAGE, number + 1)
    words = "registration" if verified is None else f"verification, {verified.planned_target or 'unplanned target'}"
    return await asyncio.to_thread(annotated_image, over.identity, place, picture, image, words)


def _reports(over: OverCase) -> list[DerivedObject]:
    """The structured report; none where no DICOM image was verified, for it speaks of images."""
    verified = {one.image_id for one in over.verifications}
    headers = {
        image.id: dcmread(BytesIO(content), stop_before_pixels=True)
        for image, content in over.images
        if image.id in verified and image.sop_uid is not None
    }
    if not headers:
        return []
    place = place_of(over.case.id, ObjectKind.STRUCTURED_REPORT)
    return [structured_report(place, device_uid(over.case.room), over.verifications, headers)]

"""Every image that arrived, to the byte, usable or not; nothing is ever replaced."""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any
from uuid import uuid4

import numpy as np
import sqlalchemy as sa
from sqlalchemy.engine import Connection

from robot.frames import Transform
from service.database import tables
from service.database.clock import now_utc
from service.errors import ErrorCode, ServiceError
from service.images.assignments import newest_assignments
from service.images.dicom_header import DicomHeader
from service.ledger.draft import describe
from service.ledger.rows import add_rows

AWAITS_STATEMENT = "awaits_statement"  # key in an image's source


@dataclass(frozen=True, slots=True)
class StoredImage:
    """An image without its bytes.

    `position` counts arrivals; `duplicate_of` is the first usable image with the same SOP UID or pixels (H02);
    `problem` (code, message, measured, limit) says why it is no usable X-ray.
    """

    id: str
    position: int
    sha256: str
    sop_uid: str | None
    pixel_sha256: str | None
    duplicate_of: str | None
    patient_id: str | None
    study_uid: str | None
    problem: Mapping[str, Any] | None
    source: Mapping[str, Any]
    metadata: Mapping[str, Any]
    received_at: str


@dataclass(frozen=True, slots=True)
class NewPurpose:
    """What an image turned out to be for; `arm` is its pose and joints during the exposure, as the guard told."""

    image_id: str
    case_id: str | None
    purpose: str
    arm: Mapping[str, Any]
    verdicts: tuple[Mapping[str, Any], ...]


def image_sent_again(connection: Connection, content: bytes, header: DicomHeader) -> StoredImage | None:
    """The image that these bytes are already, sent again; None if they are none.

    ServiceError IMAGE_UID_TAKEN where a usable image came under the same UID with other bytes; one that was cut short
    or otherwise unusable leaves its UID to the whole one.
    """
    if header.sop_uid is None:
        return None
    sha256, images = hashlib.sha256(content).hexdigest(), tables.images
    query = sa.select(images).where(images.c.sop_uid == header.sop_uid).order_by(images.c.position)
    of_uid = [StoredImage(**row._mapping) for row in connection.execute(query)]
    again = next((one for one in of_uid if one.sha256 == sha256), None)
    taken = next((one for one in of_uid if one.problem is None), None)
    if again is None and taken is not None:
        raise ServiceError(ErrorCode.IMAGE_UID_TAKEN, f"image {taken.id} came under this UID with other bytes")
    return again


def add_image(
    connection: Connection,
    content: bytes,
    header: DicomHeader,
    problem: ServiceError | None,
    source: Mapping[str, Any],
) -> StoredImage:
    """Store the bytes, once however often they come, and this arrival of them."""
    sha256 = keep_bytes(connection, content)
    image = StoredImage(
        id=uuid4().hex,
        position=count_images(connection) + 1,
        sha256=sha256,
        sop_uid=header.sop_uid,
        pixel_sha256=header.pixel_sha256,
        duplicate_of=_first_like(connection, header, sha256),
        patient_id=header.patient_id,
        study_uid=header.study_uid,
        problem=_problem_json(problem),
        source=dict(source),
        metadata=header.metadata,
        received_at=now_utc(),
    )
    add_rows(connection, tables.images, [{name: getattr(image, name) for name in StoredImage.__slots__}])
    describe(connection, action="image_stored", payload={"image_id": image.id, "sha256": sha256})
    return image


def read_image(connection: Connection, image_id: str) -> StoredImage:
    """One image; ServiceError IMAGE_UNKNOWN."""
    row = connection.execute(sa.select(tables.images).where(tables.images.c.id == image_id)).first()
    if row is None:
        raise ServiceError(ErrorCode.IMAGE_UNKNOWN, f"there is no image {image_id}")
    return StoredImage(**row._mapping)


def original_bytes(connection: Connection, image_id: str) -> bytes:
    """The bytes as they arrived; ServiceError IMAGE_UNKNOWN, or DATABASE_FAULT where they are not those any more."""
    return kept_bytes(connection, read_image(connection, image_id).sha256)


def keep_bytes(connection: Connection, content: bytes) -> str:
    """Store bytes, once however often they come; their SHA-256 names them."""
    sha256 = hashlib.sha256(content).hexdigest()
    if connection.execute(sa.select(1).where(tables.image_bytes.c.sha256 == sha256)).first() is None:
        add_rows(connection, tables.image_bytes, [{"sha256": sha256, "content": content}])
    return sha256


def kept_bytes(connection: Connection, sha256: str) -> bytes:
    """Bytes that are kept; ServiceError DATABASE_FAULT where they are not those any more."""
    query = sa.select(tables.image_bytes.c.content).where(tables.image_bytes.c.sha256 == sha256)
    content: bytes = connection.execute(query).scalar_one()
    if hashlib.sha256(content).hexdigest() != sha256:
        raise ServiceError(ErrorCode.DATABASE_FAULT, f"the stored bytes {sha256} have changed")
    return content


def list_images(
    connection: Connection, case_id: str | None = None, limit: int = 500, purpose: str | None = None
) -> list[StoredImage]:
    """The newest images (of a case, those that have a purpose in it; of one purpose), newest first."""
    images, purposes, newest = tables.images, tables.image_purposes, newest_assignments()
    query = sa.select(images).outerjoin(purposes, purposes.c.image_id == images.c.id)
    query = query.outerjoin(newest, newest.c.image_id == images.c.id).order_by(images.c.position.desc()).limit(limit)
    if case_id is not None:
        query = query.where(sa.func.coalesce(newest.c.case_id, purposes.c.case_id) == case_id)
    if purpose is not None:
        query = query.where(sa.func.coalesce(newest.c.purpose, purposes.c.purpose) == purpose)
    return [StoredImage(**row._mapping) for row in connection.execute(query)]


def count_images(connection: Connection) -> int:
    """How many images have arrived; imported ones did not, and stand at positions below zero."""
    return max(connection.execute(sa.select(sa.func.max(tables.images.c.position))).scalar() or 0, 0)


def assign_purpose(connection: Connection, purpose: NewPurpose) -> None:
    """Record what an image is for; once per image."""
    values = {
        "image_id": purpose.image_id,
        "case_id": purpose.case_id,
        "purpose": purpose.purpose,
        "arm": dict(purpose.arm),
        "verdicts": [dict(verdict) for verdict in purpose.verdicts],
        "recorded_at": now_utc(),
    }
    add_rows(connection, tables.image_purposes, [values])
    describe(connection, payload={"image_id": purpose.image_id, "purpose": purpose.purpose})


def purpose_of(connection: Connection, image_id: str) -> NewPurpose | None:
    """What an image is for, by the newest word of a person, else as it arrived; None while nobody has decided."""
    newest, purposes = newest_assignments(), tables.image_purposes
    said = connection.execute(sa.select(newest).where(newest.c.image_id == image_id)).first()
    if said is not None:
        return NewPurpose(image_id, said.case_id, said.purpose, {}, tuple(said.content["verdicts"]))
    row = connection.execute(sa.select(purposes).where(purposes.c.image_id == image_id)).first()
    if row is None:
        return None
    return NewPurpose(row.image_id, row.case_id, row.purpose, row.arm, tuple(row.verdicts))


def exposure_pose(connection: Connection, image_id: str) -> Transform:
    """`base_from_guide` as the arm held it during the exposure; ServiceError EXPOSURE_POSE_UNKNOWN."""
    purpose = purpose_of(connection, image_id)
    if purpose is None or "base_from_tcp" not in purpose.arm:
        raise ServiceError(ErrorCode.EXPOSURE_POSE_UNKNOWN, "the arm's pose during the exposure is unknown")
    return np.array(purpose.arm["base_from_tcp"], dtype=np.float64)


def images_without_purpose(connection: Connection) -> list[str]:
    """Ids of images that arrived while nobody could decide (a crash between), oldest first."""
    return [image.id for image in _without_purpose(connection) if not awaits_statement(image)]


def waiting_image(connection: Connection, content: bytes) -> StoredImage | None:
    """The image of these bytes that waits for a person's statement; None if there is none."""
    sha256 = hashlib.sha256(content).hexdigest()
    waiting = (one for one in _without_purpose(connection) if one.sha256 == sha256 and awaits_statement(one))
    return next(waiting, None)


def awaits_statement(image: StoredImage) -> bool:
    """Whether an image does not name patient, study and itself, so that a person must."""
    return bool(image.source.get(AWAITS_STATEMENT))


def _without_purpose(connection: Connection) -> list[StoredImage]:
    images, purposes = tables.images, tables.image_purposes
    query = sa.select(images).outerjoin(purposes, purposes.c.image_id == images.c.id)
    assigned = sa.exists().where(tables.image_assignments.c.image_id == images.c.id)  # in an archive of another case
    rows = connection.execute(query.where(purposes.c.image_id.is_(None), ~assigned).order_by(images.c.position))
    return [StoredImage(**row._mapping) for row in rows]


def _first_like(connection: Connection, header: DicomHeader, sha256: str) -> str | None:
    images = tables.images
    alike = [images.c.sha256 == sha256]
    if header.sop_uid is not None:
        alike.append(images.c.sop_uid == header.sop_uid)
    if header.pixel_sha256 is not None:
        alike.append(images.c.pixel_sha256 == header.pixel_sha256)
    usable = images.c.problem.is_(None)
    query = sa.select(images.c.id).where(usable, sa.or_(*alike)).order_by(images.c.position).limit(1)
    return connection.execute(query).scalar()


def _problem_json(problem: ServiceError | None) -> dict[str, Any] | None:
    if problem is None:
        return None
    return {
        "code": problem.code,
        "message": problem.message,
        "measured": problem.measured,
        "limit": problem.limit,
    }

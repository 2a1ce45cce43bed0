"""The picture of what was found in an image whose registration or verification was refused, kept beside the refusal."""

import hashlib

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.database import tables
from service.errors import ErrorCode, ServiceError
from service.images.store import keep_bytes, kept_bytes, read_image

FINDINGS = "findings_sha256"  # key in the refusal's event: names the picture, and holds it to its bytes


def findings_key(picture: bytes) -> dict[str, str]:
    """What the refusal's event says of its picture."""
    return {FINDINGS: hashlib.sha256(picture).hexdigest()}


def keep_findings(connection: Connection, picture: bytes) -> None:
    """Store a picture (PNG); the refusal that names it commits with it."""
    keep_bytes(connection, picture)


def findings_of(connection: Connection, image_id: str) -> bytes:
    """The picture of an image's newest refusal; ServiceError IMAGE_UNKNOWN, FINDINGS_UNKNOWN, DATABASE_FAULT."""
    read_image(connection, image_id)
    events = tables.events
    sha256 = events.c.data[FINDINGS].as_string()
    of_image = (events.c.data["image_id"].as_string() == image_id) & sha256.is_not(None)
    # an image enters one case at most, whose sequence orders its events; reading those of all cases takes too long
    query = sa.select(sha256).where(events.c.case_id.in_(_cases_of(image_id)), of_image)
    found = connection.execute(query.order_by(events.c.sequence.desc()).limit(1)).scalar()
    if found is None:
        raise ServiceError(ErrorCode.FINDINGS_UNKNOWN, f"no refusal of image {image_id} has a picture")
    return kept_bytes(connection, found)


def _cases_of(image_id: str) -> sa.CompoundSelect[str]:
    """The case that an image came into, and those that a person put it into."""
    tables_of_cases = (tables.image_purposes, tables.image_assignments)
    return sa.union_all(*(sa.select(table.c.case_id).where(table.c.image_id == image_id) for table in tables_of_cases))

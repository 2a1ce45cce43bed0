"""Reads a case out of the record as its replay needs it, every byte held to the hash that it was pinned by."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass, field

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from service.cases import store
from service.database import tables
from service.replay.inputs import CaseInput, Difference, Image, Registered, Step
from service.replay.steps import steps_of
from service.settings import Settings


def read_input(connection: Connection, case_id: str, current: Settings) -> CaseInput:
    """A case with everything that it was computed from; ServiceError CASE_UNKNOWN.

    A case that is older than the keeping of settings has the `current` ones, where those are its own by hash.
    """
    case = store.read_case(connection, case_id)
    steps, pins = steps_of(connection, case), _Pins(connection)
    images = {image_id: pins.image(image_id) for image_id in sorted(_images(steps))}
    devices = {one: pins.device(one) for one in sorted({one for step in steps for one in step.devices.values()})}
    settings = pins.kept(case.settings_sha256)
    if settings is None and current.fingerprint() == case.settings_sha256:
        settings = current.decisive()
    pins.hold("settings", case.settings_sha256, settings)
    return CaseInput(case_id, case.product_version, settings, images, devices, steps, tuple(pins.faults))


def _images(steps: Sequence[Step]) -> set[str]:
    first = {step.first_image_id for step in steps if isinstance(step, Registered)}
    return {image_id for image_id in first | {step.image_id for step in steps} if image_id is not None}


@dataclass(slots=True)
class _Pins:
    """Reads bytes, and remembers those that are not what they were pinned as."""

    connection: Connection
    faults: list[Difference] = field(default_factory=list)

    def image(self, image_id: str) -> Image:
        """An image, and the arm's pose during its exposure."""
        images, purposes = tables.images, tables.image_purposes
        query = sa.select(images.c.sha256, purposes.c.arm).outerjoin(purposes, purposes.c.image_id == images.c.id)
        row = self.connection.execute(query.where(images.c.id == image_id)).one()
        content = self.kept(row.sha256)
        self.hold(f"images {image_id}", row.sha256, content)
        return Image(content or b"", (row.arm or {}).get("base_from_tcp"))

    def device(self, device_id: str) -> bytes:
        """A device file."""
        files = tables.device_files
        row = self.connection.execute(sa.select(files.c.sha256, files.c.content).where(files.c.id == device_id)).one()
        self.hold(f"device_files {device_id}", row.sha256, row.content)
        return bytes(row.content)

    def kept(self, sha256: str) -> bytes | None:
        """Bytes by the name that they are kept under."""
        query = sa.select(tables.image_bytes.c.content).where(tables.image_bytes.c.sha256 == sha256)
        content = self.connection.execute(query).scalar()
        return None if content is None else bytes(content)

    def hold(self, where: str, sha256: str, content: bytes | None) -> None:
        """Hold bytes to their hash."""
        found = None if content is None else hashlib.sha256(content).hexdigest()
        if found != sha256:
            self.faults.append(Difference(where, "sha256", sha256, found))

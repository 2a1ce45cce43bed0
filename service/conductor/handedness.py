"""Handedness by a nudge, for guides without a bead (H05): proved once per C-arm connection, by two images of a view."""

import asyncio
import threading
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import sqlalchemy as sa
from sqlalchemy.engine import Connection

from robot.frames import motion_between
from service.conductor.device_set import DeviceSet, devices_of
from service.database import tables
from service.images.store import StoredImage, exposure_pose, original_bytes, purpose_of, read_image
from workflow.decisions import ImageUse
from workflow.triggers import Trigger

if TYPE_CHECKING:  # the conductor keeps what was proved
    from service.conductor.conductor import Conductor

Json = dict[str, Any]
UNPROVED = "handedness_unproved"
# From one of these to the next the C-arm stands: a raw pixel of one image is the same place in every other.
NEW_VIEW = (Trigger.CARM_POSITION_CONFIRMED, Trigger.CARM_MOVED, Trigger.RESTARTED, Trigger.DEVICE_CHANGED)


@dataclass(frozen=True, slots=True)
class CArmConnection:
    """Who sends images, and the device files they are read with; a restart of the service is another connection."""

    calling_ae: str
    address: str
    devices_sha256: str


class ProvedConnections:
    """The connections that were seen not to mirror, in this run of the service."""

    def __init__(self) -> None:
        self._proved: set[CArmConnection] = set()
        self._lock = threading.Lock()

    def remember(self, connection: CArmConnection) -> None:
        """It was proved."""
        with self._lock:
            self._proved.add(connection)

    def know(self, connection: CArmConnection) -> bool:
        """Whether it was proved."""
        with self._lock:
            return connection in self._proved


@dataclass(frozen=True, slots=True, eq=False)
class _Nudged:
    """An image with the one before the nudge."""

    first_id: str
    images: tuple[bytes, bytes]
    before_from_after: list[list[float]]
    devices: DeviceSet
    connection: CArmConnection


def connection_of(image: StoredImage, devices: DeviceSet) -> CArmConnection:
    """The connection that an image came by."""
    source = image.source
    return CArmConnection(str(source.get("calling_ae")), str(source.get("address")), devices.bytes_sha256)


async def prove_by_nudge(conductor: "Conductor", case_id: str, image_id: str, errors: Json) -> Json | None:
    """The image's registration, if it and one before a nudge prove the handedness of the connection; else why not.

    None where no earlier image of the view can tell.
    """
    nudged = await asyncio.to_thread(_nudged, conductor, case_id, image_id)
    if nudged is None:
        return None
    devices = nudged.devices
    result = await conductor.parts.vision.handedness(
        nudged.images, devices.guide, devices.carm, nudged.before_from_after, errors
    )
    if result["status"] == "registered":
        conductor.proved.remember(nudged.connection)
        result["nudge"] |= {"first_image_id": nudged.first_id}
        return result
    return result | {"first_image_id": nudged.first_id}


def _nudged(conductor: "Conductor", case_id: str, image_id: str) -> _Nudged | None:
    with conductor.parts.database.read() as connection:
        devices = devices_of(connection, case_id)
        image = read_image(connection, image_id)
        for first_id in _earlier_of_the_view(connection, case_id, image_id):
            first = read_image(connection, first_id)
            if connection_of(first, devices) != connection_of(image, devices):
                continue
            poses = [exposure_pose(connection, one) for one in (first_id, image_id)]
            return _Nudged(
                first_id,
                (original_bytes(connection, first_id), original_bytes(connection, image_id)),
                motion_between(*poses).tolist(),
                devices,
                connection_of(image, devices),
            )
    return None


def _earlier_of_the_view(connection: Connection, case_id: str, image_id: str) -> list[str]:
    """Images for registration since the C-arm was last said to stand or to have moved, the newest first."""
    events = tables.events
    in_case = events.c.case_id == case_id
    newest_view = sa.select(sa.func.max(events.c.sequence)).where(in_case, events.c.trigger.in_(NEW_VIEW))
    since = connection.execute(newest_view).scalar() or 0
    arrived = sa.select(events.c.data).where(
        in_case, events.c.trigger == Trigger.IMAGE_ARRIVED, events.c.sequence > since
    )
    ids = [data["image_id"] for data in connection.execute(arrived.order_by(events.c.sequence.desc())).scalars()]
    purposes = {one: purpose_of(connection, one) for one in ids if one != image_id}
    return [one for one, given in purposes.items() if given is not None and given.purpose == ImageUse.REGISTRATION]

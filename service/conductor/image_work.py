"""Image work asked of the vision worker, with what it needs from the database."""

import asyncio
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from sqlalchemy.engine import Connection

from robot.frames import motion_between
from service.cases import store
from service.cases.records import ArtefactKind
from service.conductor.conductor import Conductor
from service.conductor.device_set import DeviceSet, devices_of
from service.conductor.handedness import UNPROVED, CArmConnection, connection_of, prove_by_nudge
from service.errors import ServiceError
from service.images.store import exposure_pose, original_bytes, read_image
from service.motion_errors import motion_errors
from workflow.facts import RegistrationQuality

Json = dict[str, Any]


@dataclass(frozen=True, slots=True, eq=False)
class ImageInputs:
    """What an image is worked on with."""

    image: bytes
    devices: DeviceSet
    connection: CArmConnection


async def register_image(conductor: Conductor, case_id: str, image_id: str) -> Json:
    """Find the guide in a stored image; refused as JSON, ServiceError where the work failed.

    Without a bead, a nudge between an earlier image of the view and this one proves the handedness (H05).
    """
    inputs = await asyncio.to_thread(_inputs, conductor, case_id, image_id)
    devices, proved = inputs.devices, conductor.proved.know(inputs.connection)
    result = await conductor.parts.vision.register(inputs.image, devices.guide, devices.carm, proved)
    if result["status"] == "registered" or result["reason"]["code"] != UNPROVED:
        return result
    nudged = await prove_by_nudge(conductor, case_id, image_id, _errors_of(conductor, devices))
    return nudged or result


async def evaluate_image(conductor: Conductor, case_id: str, image_id: str, target: Mapping[str, Any]) -> Json:
    """How well the guide points at a target of the case, from an image after the move, held against the one before.

    The target crosses images as a raw pixel and is corrected in each anew.
    """
    inputs = await asyncio.to_thread(_inputs, conductor, case_id, image_id)
    before = await asyncio.to_thread(_before, conductor, case_id, image_id, target)
    before["handedness_proved"] = conductor.proved.know(inputs.connection)
    devices, pixel = inputs.devices, _pair(target["raw_px"])
    depth_mm = float(target["depth_mm"])
    return await conductor.parts.vision.evaluate(inputs.image, devices.guide, devices.carm, pixel, depth_mm, before)


async def aim(
    conductor: Conductor, case_id: str, registration: Json, raw_px: tuple[float, float], depth_mm: float
) -> Json:
    """Where the guide must go, and what the next image will see; ServiceError with vision's code where it says no."""
    errors = await asyncio.to_thread(_motion_errors, conductor, case_id)
    return accepted(await conductor.parts.vision.target(registration, raw_px, depth_mm, errors))


async def draw_back(conductor: Conductor, image_id: str, registration: Json, pixel: Json) -> Json:
    """The picked point in both grids, and a crop of the image with the point drawn in (H08)."""
    image = await asyncio.to_thread(_image, conductor, image_id)
    vision = conductor.parts.vision
    return accepted(await vision.run("echo", image, registration, _pair(pixel["pixel_px"]), pixel["space"]))


async def guide_in_image(conductor: Conductor, case_id: str, image_id: str) -> bool | None:
    """Whether the guide is found in an image whose exposure pose is known; None if nobody can tell."""
    if conductor.bridge.watch.exposure_of_image(image_id) is None:
        return None
    result = await register_image(conductor, case_id, image_id)
    return bool(result["status"] == "registered")


def registration_json(connection: Connection, registration_id: str) -> Json:
    """A registration as it was recorded."""
    return dict(store.read_artefact(connection, ArtefactKind.REGISTRATION, registration_id).content)


def quality_of(registration: Mapping[str, Any]) -> RegistrationQuality:
    """What a registration measured about itself, for the interlocks."""
    predicted, carm = registration["predicted_error_95"], registration["carm"]
    return RegistrationQuality(
        handedness_proved=registration.get("bead_px") is not None or registration.get("handedness_by") == "nudge",
        plate_required=carm.get("plate") is not None,
        plate_balls=registration["distortion"].get("balls"),
        scale_error=_scale_error(registration),
        fiducials=len(registration["fiducials_px"]),
        residual_rms_px=registration["residual_rms_px"],
        predicted_angle_rad=math.radians(predicted["angle_deg"]),
        predicted_position_mm=predicted["position_mm"],
    )


def _scale_error(registration: Mapping[str, Any]) -> float:
    """Relative difference of the fitted focal length from what the C-arm file says, both in pixels."""
    carm, columns = registration["carm"], registration["image"]["columns"]
    nominal_px = carm["source_to_image_mm"] * columns / carm["field_of_view_mm"]
    fitted_px = float(registration["intrinsics_px"]["alpha_x"])
    return abs(fitted_px / float(nominal_px) - 1.0)


def accepted(result: Json) -> Json:
    """The result of image work, unless it is a refusal: ServiceError with vision's own code."""
    if result["status"] == "refused":
        reason = result["reason"]
        raise ServiceError(
            reason["code"], reason["message"], measured=reason.get("measured"), limit=reason.get("limit")
        )
    return result


def _inputs(conductor: Conductor, case_id: str, image_id: str) -> ImageInputs:
    with conductor.parts.database.read() as connection:
        devices = devices_of(connection, case_id)
        came_by = connection_of(read_image(connection, image_id), devices)
        return ImageInputs(original_bytes(connection, image_id), devices, came_by)


def _before(conductor: Conductor, case_id: str, image_id: str, target: Mapping[str, Any]) -> Json:
    """What a verification image is held against: the image of its target, and the arm's motion between the two."""
    first_id = str(target["image_id"])
    with conductor.parts.database.read() as connection:
        poses = [exposure_pose(connection, one) for one in (first_id, image_id)]
        return {
            "image": original_bytes(connection, first_id),
            "registration": registration_json(connection, str(target["registration_id"])),
            "before_from_after": motion_between(*poses).tolist(),
            "errors": _errors_of(conductor, devices_of(connection, case_id)),
        }


def _motion_errors(conductor: Conductor, case_id: str) -> Json:
    with conductor.parts.database.read() as connection:
        return _errors_of(conductor, devices_of(connection, case_id))


def _errors_of(conductor: Conductor, devices: DeviceSet) -> Json:
    return motion_errors(conductor.parts.settings.arm_accuracy, devices.tool)


def _image(conductor: Conductor, image_id: str) -> bytes:
    with conductor.parts.database.read() as connection:
        return original_bytes(connection, image_id)


def _pair(values: Any) -> tuple[float, float]:
    u_px, v_px = values
    return float(u_px), float(v_px)

"""What the daily check looks at: each item measured, with its limit, and what to do where it fails."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from datetime import UTC, date, datetime
from typing import Any

import numpy as np
from sqlalchemy.engine import Connection

from robot.beam import beam_tilt
from robot.poses import tcp_difference
from robot.safety import may_move
from robot.tool import Tool, read_tool
from service.devices.store import DeviceKind, StoredDevice, device_bytes, expired, newest_device
from service.errors import answer_for
from service.images.store import StoredImage
from service.motion.arm_watch import ArmReading
from service.motion.exposures import Exposure
from vision.carm_angles import beam_tilt_rad
from workflow.limits import Limits

Json = Mapping[str, Any]
# Own choice: the dials of a C-arm and the levelling of the arm's cart are good to a degree or two. It finds a guide
# that is mounted turned and a TCP file of another tool; fine errors are the calibration's.
BEAM_TILT_LIMIT_DEG = 3.0


@dataclass(frozen=True, slots=True)
class CheckItem:
    """One thing that was looked at; `what_to_do` is empty where it passed."""

    code: str
    passed: bool
    measured: float | str | bool | None
    limit: float | str | bool | None
    unit: str
    what_to_do: str


def item(
    code: str, passed: bool, measured: float | str | bool | None, limit: float | str | bool | None, unit: str, cure: str
) -> CheckItem:
    """An item, with its cure only where it is needed."""
    return CheckItem(code, passed, measured, limit, unit, "" if passed else cure)


def device_items(connection: Connection) -> list[CheckItem]:
    """The newest file of each kind is in date; ServiceError DEVICE_UNKNOWN where there is none."""
    today = datetime.now(UTC).date()
    return [_in_date(newest_device(connection, kind), today) for kind in DeviceKind]


def newest_tool(connection: Connection) -> Tool:
    """The TCP file that the next case would use."""
    return read_tool(device_bytes(connection, newest_device(connection, DeviceKind.TCP).id))


def arm_items(reading: ArmReading | None, tool: Tool, limits: Limits) -> list[CheckItem]:
    """The arm answers, is ready and at rest, with the TCP and the payload of the tool file."""
    arm = reading.arm if reading is not None else None
    if reading is None or arm is None or not reading.arm_age_s <= limits.feedback_age_s:
        age_s = None if reading is None or arm is None else reading.arm_age_s
        cure = "Switch the arm on; check its network and the address in the settings."
        return [item("arm_reachable", False, age_s, limits.feedback_age_s, "s", cure)]
    offset_mm, turn_rad = tcp_difference(arm, tool)
    payload_kg = abs(arm.payload_kg - tool.payload_kg)
    ready, at_rest = may_move(arm.safety), reading.at_rest is True
    tcp = "Set the controller's TCP as the tool file has it, or calibrate the TCP anew."
    return [
        item("arm_reachable", True, reading.arm_age_s, limits.feedback_age_s, "s", ""),
        item("arm_ready", ready, arm.safety.value, "normal or reduced", "", "Clear the stop at the pendant."),
        item("arm_at_rest", at_rest, at_rest, True, "", "Wait until the arm is at rest."),
        item("tcp_mm", offset_mm <= limits.tcp_difference_mm, offset_mm, limits.tcp_difference_mm, "mm", tcp),
        item("tcp_rad", turn_rad <= limits.tcp_difference_rad, turn_rad, limits.tcp_difference_rad, "rad", tcp),
        item(
            "payload_kg",
            payload_kg <= limits.payload_difference_kg,
            payload_kg,
            limits.payload_difference_kg,
            "kg",
            "Set the controller's payload as the tool file has it.",
        ),
    ]


def still_items(exposure: Exposure | None, limits: Limits) -> list[CheckItem]:
    """The arm stood from the beginning of the check until now (H04)."""
    moved_mm = None if exposure is None else exposure.largest.offset_mm
    turned_rad = None if exposure is None else exposure.largest.angle_rad
    still = moved_mm is not None and moved_mm <= limits.unaccounted_mm
    unturned = turned_rad is not None and turned_rad <= limits.unaccounted_rad
    cure = "Leave the arm alone and begin the check anew."
    return [
        item("still_mm", still, moved_mm, limits.unaccounted_mm, "mm", cure),
        item("still_rad", unturned, turned_rad, limits.unaccounted_rad, "rad", cure),
    ]


def image_items(result: Json, image: StoredImage, exposure: Exposure | None) -> list[CheckItem]:
    """The guide is found in the image, and image and arm put the beam where the C-arm says it is."""
    if result["status"] != "registered":
        reason = result["reason"]
        cure = answer_for(reason["code"]).what_to_do
        return [item("registration", False, reason["code"], "registered", "", cure)]
    found = item("registration", True, "registered", "registered", "", "")
    return [found] if exposure is None else [found, _beam_item(result, image, exposure)]


def _beam_item(result: Json, image: StoredImage, exposure: Exposure) -> CheckItem:
    seen_rad = beam_tilt(exposure.latched.base_from_tcp, np.array(result["source_from_guide"]))
    told = [image.metadata.get(f"positioner_{which}_deg") for which in ("primary", "secondary")]
    cure = (
        "Check that the base stands upright and the C-arm's dials are right; then that guide and TCP file are those of"
        " the mounted tool, and calibrate the TCP anew."
    )
    if None in told:
        return item("beam_tilt", False, None, BEAM_TILT_LIMIT_DEG, "deg", "Let the C-arm send its positioner angles.")
    told_rad = beam_tilt_rad(*(math.radians(float(angle)) for angle in told if angle is not None))
    apart_deg = math.degrees(abs(seen_rad - told_rad))
    return item("beam_tilt", apart_deg <= BEAM_TILT_LIMIT_DEG, apart_deg, BEAM_TILT_LIMIT_DEG, "deg", cure)


def _in_date(device: StoredDevice, today: date) -> CheckItem:
    good = not expired(device, today)
    cure = f"Calibrate, and upload a new {device.kind} file."
    return item(f"{device.kind}_in_date", good, device.expires or "no expiry", today.isoformat(), "", cure)

"""What the interlocks are told of the world: every reading with its measured age, unknown where nothing was read."""

import math
from dataclasses import dataclass, replace
from typing import Any

from robot.guard.messages import Phase
from robot.poses import tcp_difference
from robot.tool import Tool
from service.conductor.configuration import Configuration
from service.conductor.device_set import DeviceSet
from service.motion.arm_watch import ArmReading, ArmWatch
from service.motion.displacement import Displacement
from workflow.case import CaseState
from workflow.snapshot import Reading, SafetyMode, SafetySnapshot
from workflow.triggers import Trigger

# Waited for at most, so that a machine under load refuses nothing for a reading that is just arriving.
_WAIT_S = 0.3
_UNKNOWN: Reading[Any] = Reading(None, math.inf)
# These rely on the pose of another exposure than that of the case's image.
OF_ANOTHER_IMAGE = (Trigger.NEWEST_IMAGE_REUSED, Trigger.CORRECTION_REQUESTED)


@dataclass(frozen=True, slots=True)
class Held:
    """What the arm's side of a snapshot does not know: who holds control, which devices and settings the case uses."""

    control_token: int | None
    devices: DeviceSet | None
    configuration: Configuration


def measure(watch: ArmWatch, case: CaseState, trigger: Trigger, held: Held) -> SafetySnapshot:
    """The world now, for a decision about a case."""
    reading = watch.reading(_WAIT_S)
    drift = watch.drift()
    arm_age_s = math.inf if reading is None else reading.arm_age_s
    devices = held.devices
    return SafetySnapshot(
        **_arm(reading),
        **_guard(reading),
        **_image(watch, _image_of(case, trigger), arm_age_s),
        drift_mm=_offset(drift, arm_age_s),
        drift_rad=_angle(drift, arm_age_s),
        **_tool(reading, devices.tool if devices else None),
        devices_hash=Reading(devices.sha256, 0.0) if devices else _UNKNOWN,
        devices_in_date=Reading(devices.in_date, 0.0) if devices else _UNKNOWN,
        configuration=Reading(held.configuration.now, 0.0),
        configuration_opened=Reading(held.configuration.opened, 0.0),
        control_token=Reading(held.control_token, 0.0),
    )


def measured_for(snapshot: SafetySnapshot, watch: ArmWatch, case: CaseState, trigger: Trigger) -> SafetySnapshot:
    """The same moment, with the readings of the image that another trigger relies on."""
    return replace(snapshot, **_image(watch, _image_of(case, trigger), snapshot.joints_rad.age_s))


def as_locked(snapshot: SafetySnapshot) -> SafetySnapshot:
    """The same moment as the start of an insertion finds it: that request first locks a guard that answers (H29)."""
    locked = snapshot.motion_locked
    return snapshot if locked.value is None else replace(snapshot, motion_locked=replace(locked, value=True))


def _image_of(case: CaseState, trigger: Trigger) -> str | None:
    """The image whose exposure pose the request relies on."""
    if trigger is Trigger.CORRECTION_REQUESTED:
        return case.verification.image_id if case.verification else None
    if trigger is Trigger.NEWEST_IMAGE_REUSED:
        return case.newest_image_id
    return case.image.id if case.image else None


def _image(watch: ArmWatch, image_id: str | None, arm_age_s: float) -> dict[str, Reading[Any]]:
    unaccounted, exposed_s = watch.unaccounted(image_id), watch.since_exposure_s(image_id)
    return {
        "image_exposed": _UNKNOWN if exposed_s is None else Reading(True, exposed_s),
        "unaccounted_mm": _offset(unaccounted, arm_age_s),
        "unaccounted_rad": _angle(unaccounted, arm_age_s),
    }


def _arm(reading: ArmReading | None) -> dict[str, Reading[Any]]:
    names = ("joints_rad", "at_rest", "safety_mode", "controller_time_s", "feedback_advances", "program_running")
    if reading is None or reading.arm is None:
        return dict.fromkeys(names, _UNKNOWN)
    arm, age_s = reading.arm, reading.arm_age_s
    values = (
        tuple(map(float, arm.joints_rad)),
        reading.at_rest,
        SafetyMode(arm.safety.value),
        arm.controller_time_s,
        reading.advances,
        arm.program_running,
    )
    return {name: Reading(value, age_s) for name, value in zip(names, values, strict=True)}


def _guard(reading: ArmReading | None) -> dict[str, Reading[Any]]:
    if reading is None:
        return dict.fromkeys(("guard_alive", "motion_locked", "hold_pressed", "challenge_echoed"), _UNKNOWN)
    status, age_s = reading.status, reading.status_age_s
    echo_age_s = math.inf if status.heartbeat_age_s is None else status.heartbeat_age_s + age_s
    return {
        "guard_alive": Reading(True, age_s),
        "motion_locked": Reading(status.phase is Phase.HELD, age_s),
        # The guard tells one age, that of the echoed challenge; the heartbeat that brought it is younger.
        "hold_pressed": Reading(status.held, echo_age_s),
        "challenge_echoed": Reading(status.heartbeat_age_s is not None, echo_age_s),
    }


def _tool(reading: ArmReading | None, tool: Tool | None) -> dict[str, Reading[Any]]:
    if reading is None or reading.arm is None or tool is None:
        return dict.fromkeys(("tcp_difference_mm", "tcp_difference_rad", "payload_difference_kg"), _UNKNOWN)
    offset_mm, angle_rad = tcp_difference(reading.arm, tool)
    return {
        "tcp_difference_mm": Reading(offset_mm, reading.arm_age_s),
        "tcp_difference_rad": Reading(angle_rad, reading.arm_age_s),
        "payload_difference_kg": Reading(abs(reading.arm.payload_kg - tool.payload_kg), reading.arm_age_s),
    }


def _offset(displacement: Displacement | None, age_s: float) -> Reading[float]:
    return _UNKNOWN if displacement is None else Reading(displacement.offset_mm, age_s)


def _angle(displacement: Displacement | None, age_s: float) -> Reading[float]:
    return _UNKNOWN if displacement is None else Reading(displacement.angle_rad, age_s)

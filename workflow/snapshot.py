"""What the service must know about the world when it asks for a decision."""

import math
from dataclasses import dataclass, fields
from enum import StrEnum
from functools import cache
from typing import Generic, TypeVar

T_co = TypeVar("T_co", covariant=True)


class SafetyMode(StrEnum):
    """What the controller's safety bits say."""

    NORMAL = "normal"
    REDUCED = "reduced"
    PROTECTIVE_STOP = "protective_stop"
    SAFEGUARD_STOP = "safeguard_stop"
    EMERGENCY_STOP = "emergency_stop"
    RECOVERY = "recovery"
    VIOLATION = "violation"
    FAULT = "fault"
    OFF = "off"


@dataclass(frozen=True, slots=True)
class Reading(Generic[T_co]):
    """A value, None if unknown, and how long ago it was true (s, by the monotonic clock)."""

    value: T_co | None
    age_s: float


@dataclass(frozen=True, slots=True)
class SafetySnapshot:
    """Every reading that an interlock may ask for; no field has a default, so none can be forgotten."""

    # The arm, from the guard's status.
    joints_rad: Reading[tuple[float, ...]]
    at_rest: Reading[bool]
    safety_mode: Reading[SafetyMode]
    controller_time_s: Reading[float]  # NaN if the controller sends no number
    feedback_advances: Reading[bool]  # the controller's clock went on between the newest two packets
    guard_alive: Reading[bool]
    program_running: Reading[bool]  # any control script on the controller
    motion_locked: Reading[bool]  # the guard refuses every motion until it is unlocked
    # The image that the request relies on; the age counts from the request of its exposure.
    image_exposed: Reading[bool]
    # TCP displacement that no commanded motion accounts for, since the image (since the exposure request before it).
    unaccounted_mm: Reading[float]
    unaccounted_rad: Reading[float]
    # TCP displacement from where the arm came to rest for the verification.
    drift_mm: Reading[float]
    drift_rad: Reading[float]
    # What the controller uses, against the tool file of the case.
    tcp_difference_mm: Reading[float]
    tcp_difference_rad: Reading[float]
    payload_difference_kg: Reading[float]
    # Device files now selected: one hash over all of them, and whether none has expired.
    devices_hash: Reading[str]
    devices_in_date: Reading[bool]
    # One hash over program version, settings and device files: as they are, and as they were when the case was opened.
    configuration: Reading[str]
    configuration_opened: Reading[str]
    # The person's hand: `age_s` of the hold counts from its arrival, that of the echo from when its challenge was made.
    hold_pressed: Reading[bool]
    challenge_echoed: Reading[bool]
    control_token: Reading[int]  # fencing token of the control lease now


@cache
def unknown_snapshot() -> SafetySnapshot:
    """A snapshot that knows nothing, so that every interlock refuses."""
    return SafetySnapshot(**{field.name: Reading(None, math.inf) for field in fields(SafetySnapshot)})

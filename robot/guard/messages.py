"""What the service and the guard say to each other: one JSON object a line.

Transforms are 4x4 in mm, times are seconds of CLOCK_MONOTONIC, which every process of a machine shares.
"""

import re
from dataclasses import dataclass
from enum import StrEnum
from typing import TypeAlias

import numpy as np

from robot.arm import ArmState
from robot.frames import Array, Transform, check_rigid
from robot.refusal import Refusal

_PERMIT_ID = re.compile(r"[A-Za-z0-9_-]{1,64}")


class Phase(StrEnum):
    """Where the guard is. Held: refuses every motion until `Acknowledge`."""

    HELD = "held"
    IDLE = "idle"
    STARTING = "starting"
    MOVING = "moving"
    STOPPING = "stopping"


class EndCause(StrEnum):
    """Why a motion ended. The guard is idle after arrived, missed and released at rest without a program, else held."""

    ARRIVED = "arrived"
    MISSED = "missed"
    RELEASED = "released"
    STOPPED = "stopped"
    HEARTBEAT_LOST = "heartbeat_lost"
    FEEDBACK_LOST = "feedback_lost"
    PARENT_LOST = "parent_lost"
    OVERSPEED = "overspeed"
    NOT_STARTED = "not_started"  # commanded, and the arm did not leave its place
    OVERDUE = "overdue"  # still moving long after it should have arrived
    CONTROL_LOST = "control_lost"
    OFF_PATH = "off_path"  # the arm is not on the approved line
    FORCE_RISE = "force_rise"
    TCP_CHANGED = "tcp_changed"  # at the pendant, amid the motion; so the payload
    PAYLOAD_CHANGED = "payload_changed"
    PROTECTIVE_STOP = "protective_stop"
    SAFEGUARD_STOP = "safeguard_stop"
    EMERGENCY_STOP = "emergency_stop"
    SAFETY_FAULT = "safety_fault"
    ARM_OFF = "arm_off"


class FaultKind(StrEnum):
    """A fault seen without a motion; each latches the guard into held."""

    FEEDBACK_LOST = "feedback_lost"
    PROTECTIVE_STOP = "protective_stop"
    SAFEGUARD_STOP = "safeguard_stop"
    EMERGENCY_STOP = "emergency_stop"
    SAFETY_FAULT = "safety_fault"
    ARM_OFF = "arm_off"
    GUARD_LOST = "guard_lost"  # said by the client: the process died or fell silent


@dataclass(frozen=True, slots=True, eq=False)
class BeginMove:
    """Start a motion under a permit; needs a live, held heartbeat of the same permit.

    ValueError unless every number is finite and the transforms are rigid.

    Attributes
    ----------
    permit_id : str
        As in `Heartbeat`; single use, for the life of the guard too.
    start_joints_rad : (6,)
        Joints bound by the permit (H04).
    flange_from_guide, payload_kg, payload_centre_mm
        Must be what the controller reports, within the tolerances (H10).
    """

    permit_id: str
    base_from_goal: Transform
    start_joints_rad: Array
    speed_mm_s: float
    acceleration_mm_s2: float
    duration_s: float
    flange_from_guide: Transform
    payload_kg: float
    payload_centre_mm: Array
    tcp_tolerance_mm: float
    tcp_tolerance_rad: float
    payload_tolerance_kg: float
    payload_tolerance_mm: float

    def __post_init__(self) -> None:
        _check_permit(self.permit_id)
        check_rigid(self.base_from_goal)
        check_rigid(self.flange_from_guide)
        _check_finite(self.start_joints_rad, 6)
        _check_finite(self.payload_centre_mm, 3)
        if not (0.0 < self.speed_mm_s < np.inf and 0.0 < self.acceleration_mm_s2 < np.inf):
            raise ValueError("a motion has a speed and an acceleration")
        tolerances = (
            self.tcp_tolerance_mm,
            self.tcp_tolerance_rad,
            self.payload_tolerance_kg,
            self.payload_tolerance_mm,
        )
        if not all(0.0 <= value < np.inf for value in (self.payload_kg, self.duration_s, *tolerances)):
            raise ValueError("payload, tolerances and duration are finite and not negative")


@dataclass(frozen=True, slots=True)
class Heartbeat:
    """The surgeon's hold, for each challenge: number rises within a permit, challenge is the newest that was seen.

    ValueError unless the permit's id is 1 to 64 letters, digits, underscores or hyphens: it names a file.
    """

    permit_id: str
    number: int
    challenge: str
    held: bool

    def __post_init__(self) -> None:
        _check_permit(self.permit_id)


@dataclass(frozen=True, slots=True)
class Stop:
    """Stop the arm now, in every phase."""

    reason: str


@dataclass(frozen=True, slots=True)
class ReleasePendant:
    """Stop as `Stop` does, and leave the arm to a person at the pendant: nothing of ours but the feedback remains."""

    reason: str


@dataclass(frozen=True, slots=True)
class Acknowledge:
    """A human has acknowledged: held becomes idle. Never starts anything."""


@dataclass(frozen=True, slots=True, eq=False)
class Status:
    """At least 20 a second.

    Attributes
    ----------
    sequence : int
    sent_at_s : float
    challenge : str
        To be echoed in the next heartbeat.
    connected : bool
        Whether the controller's feedback is advancing.
    arm : ArmState or None
        Newest reading, however old; its age is sent_at_s - arm.received_at_s. None before the first.
    held, heartbeat_age_s : bool, float or None
        Of the newest heartbeat; the age is that of the challenge it echoed.
    """

    sequence: int
    sent_at_s: float
    phase: Phase
    challenge: str
    connected: bool
    arm: ArmState | None
    permit_id: str | None
    held: bool
    heartbeat_age_s: float | None


@dataclass(frozen=True, slots=True, eq=False)
class MotionStarted:
    """The motion was put on the wire; with the TCP and payload that the controller reported."""

    permit_id: str
    at_s: float
    base_from_start: Transform
    joints_rad: Array
    flange_from_tcp: Transform
    payload_kg: float
    payload_centre_mm: Array


@dataclass(frozen=True, slots=True, eq=False)
class MotionEnded:
    """A motion is over and its program gone.

    Attributes
    ----------
    at_rest : bool
        Seen at rest; False if the feedback was lost before that.
    distance_mm, angle_rad : float or None
        From the goal; None without feedback.
    arm : ArmState or None
        Last reading.
    stop_sent_at_s : float or None
        When the stop went out.
    trajectory_file, trajectory_samples
        JSON lines at the controller's rate, in the journal's folder.
    program_stopped : bool
        No program was running on the controller at the end.
    """

    permit_id: str
    cause: EndCause
    at_s: float
    at_rest: bool
    program_stopped: bool
    distance_mm: float | None
    angle_rad: float | None
    arm: ArmState | None
    stop_sent_at_s: float | None
    trajectory_file: str
    trajectory_samples: int


@dataclass(frozen=True, slots=True)
class MoveRefused:
    """A motion was refused before the first packet of it; the permit is spent."""

    permit_id: str
    at_s: float
    refusal: Refusal


@dataclass(frozen=True, slots=True)
class StopSent:
    """A requested stop went out, or could not (`written` False: the controller is away)."""

    reason: str
    at_s: float
    written: bool


@dataclass(frozen=True, slots=True)
class PendantReleased:
    """The pendant has the arm.

    Attributes
    ----------
    program_running : bool or None
        Whether a program runs on the controller all the same; None without sound feedback.
    """

    at_s: float
    program_running: bool | None


@dataclass(frozen=True, slots=True)
class Fault:
    """A fault without a motion."""

    kind: FaultKind
    at_s: float
    message: str


@dataclass(frozen=True, slots=True)
class Disturbed:
    """The arm is displaced by more than 0.05 mm or 0.02 deg and no motion accounts for it (H04)."""

    at_s: float
    offset_mm: float
    angle_rad: float


Command: TypeAlias = BeginMove | Heartbeat | Stop | ReleasePendant | Acknowledge
Event: TypeAlias = Status | MotionStarted | MotionEnded | MoveRefused | StopSent | PendantReleased | Fault | Disturbed


def _check_permit(permit_id: str) -> None:
    if _PERMIT_ID.fullmatch(permit_id) is None:
        raise ValueError("the permit's id is not of 1 to 64 letters, digits, underscores or hyphens")


def _check_finite(values: Array, count: int) -> None:
    if np.shape(values) != (count,) or not np.isfinite(values).all():
        raise ValueError(f"expected {count} finite numbers")

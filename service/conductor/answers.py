"""What a caller gets back."""

from typing import Any

from pydantic import BaseModel

Measured = float | str | bool | None


class VerdictAnswer(BaseModel):
    """One interlock's answer."""

    code: str
    hazard: str
    passed: bool
    measured: Measured
    limit: Measured
    unit: str
    message: str
    hard_limit: float | None
    override: str | None
    overridable: bool


class CommandAnswer(BaseModel):
    """What a command did. `version` is the case's now, for the next If-Match; `made` maps a kind to the id made."""

    case_id: str
    trigger: str
    taken_as: str
    outcome: str
    state: str
    version: int
    sequence: int
    made: dict[str, str]
    voided: list[str]
    verdicts: list[VerdictAnswer]
    detail: dict[str, Any]


class StopAnswer(BaseModel):
    """What was sent, and whether it is in the record yet; the stop itself never waits for the record."""

    sent_to_guard: bool
    recorded: bool
    case_id: str | None
    version: int | None


class EmergencyAccessAnswer(StopAnswer):
    """Beside the stop, whether the guard has left the arm to the pendant and saw no program run on the controller."""

    pendant_released: bool


class EchoAnswer(BaseModel):
    """The picked point as the server understood it, drawn back (H08)."""

    echo_id: str
    image_id: str
    registration_id: str
    raw_px: tuple[float, float]
    corrected_px: tuple[float, float]
    crop_png_base64: str
    crop_origin_px: tuple[int, int]
    crop_scale: int


class OverlayAnswer(BaseModel):
    """Lines over an image, raw pixels (u, v).

    `goal` is where the guide's wires are to appear after the motion, `way` how the small ring's centre comes there.
    """

    wires: dict[str, list[tuple[float, float]]]
    fiducials: dict[str, tuple[float, float]]
    bead: tuple[float, float] | None
    balls: list[tuple[float, float]]
    targets: list[dict[str, Any]]
    bounds: list[tuple[float, float]]
    bounds_times: float
    goal: dict[str, list[tuple[float, float]]]
    way: list[tuple[float, float]]


class LeaseAnswer(BaseModel):
    """Who holds control; `yours` for the session that asks."""

    held: bool
    user_id: str | None
    user: str | None
    control_token: int | None
    taken_at: str | None
    yours: bool


class ArmAnswer(BaseModel):
    """The arm as last measured."""

    age_s: float | None
    connected: bool
    phase: str | None
    safety: str | None
    at_rest: bool | None
    program_running: bool | None
    joints_deg: list[float] | None
    base_from_tcp: list[list[float]] | None
    tcp_speed_mm_s: float | None


class ReasonAnswer(BaseModel):
    """One reason why a trigger is refused now; `overridable`: not with a surgeon's reason, sent under `overrides`."""

    code: str
    message: str
    measured: Measured
    limit: Measured
    unit: str
    hard_limit: float | None = None
    overridable: bool = False


class AllowanceAnswer(BaseModel):
    """Whether a trigger would be taken now, else every reason why not and what leads onwards.

    `permitted` for the role of the session that asks; `needs_control` where the control lease goes with the request.
    """

    allowed: bool
    permitted: bool
    needs_control: bool
    reasons: list[ReasonAnswer]
    leads_onwards: list[str]


class StatusAnswer(BaseModel):
    """One atomic status of a case."""

    case_id: str
    state: str
    version: int
    sequence: int
    guide: str
    guide_empty: bool
    held_for: str | None
    chain: dict[str, str | None]
    insertion: dict[str, Any] | None
    running_motion: dict[str, Any] | None
    corrections: int
    images: int
    allowed: dict[str, AllowanceAnswer]
    arm: ArmAnswer
    lease: LeaseAnswer
    alarms: list[str]
    targets: dict[str, str]


class CArmAnglesAnswer(BaseModel):
    """The C-arm's angles for a planned path, degrees, as `coaxial plan-carm` prints them."""

    target: str
    primary_angle_deg: float
    secondary_angle_deg: float
    rotation_from_vertical_deg: float
    angulation_from_vertical_deg: float
    orbital_deg: float
    tilt_deg: float
    words: str

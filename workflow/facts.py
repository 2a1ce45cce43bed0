"""What comes with each trigger: ids made by the service, and what was measured. None means unknown."""

from dataclasses import dataclass
from enum import StrEnum

from workflow.overrides import Override
from workflow.plans import PlanKind
from workflow.states import GuideState
from workflow.triggers import Trigger


@dataclass(frozen=True, slots=True)
class Approval:
    """Who asks: role, lease token and whether the PIN was given with this very request."""

    person_id: str
    surgeon: bool
    pin_confirmed: bool
    control_token: int


@dataclass(frozen=True, slots=True)
class CarmPositionConfirmed:
    """A person says that the C-arm stands where the next image is to be taken."""

    view_id: str


@dataclass(frozen=True, slots=True)
class ExposureRequested:
    """A person is about to expose."""

    window_id: str


@dataclass(frozen=True, slots=True)
class ImageArrived:
    """An image was stored. Displacements are the TCP's largest between exposure request and arrival."""

    image_id: str
    patient_matches: bool | None
    study_matches: bool | None
    sop_uid_unseen: bool | None
    pixels_unseen: bool | None
    newer_by_carm_clock: bool | None  # than the C-arm's previous image, by the C-arm's own clock
    moved_mm: float | None
    moved_rad: float | None


@dataclass(frozen=True, slots=True)
class NewestImageReused:
    """Take the newest image again instead of exposing."""

    image_id: str
    guide_in_image: bool | None


@dataclass(frozen=True, slots=True)
class RegistrationQuality:
    """What a registration measured about itself; predicted bounds are 95 %, for a target at the small ring's centre."""

    handedness_proved: bool | None  # by the bead in this image (H05)
    plate_required: bool | None  # the device is an image intensifier
    plate_balls: int | None
    scale_error: float | None  # relative, of the fitted focal length in pixels against the C-arm file
    fiducials: int | None
    residual_rms_px: float | None
    predicted_angle_rad: float | None
    predicted_position_mm: float | None


@dataclass(frozen=True, slots=True)
class RegistrationCompleted:
    """The guide was found in the image."""

    registration_id: str
    image_id: str
    quality: RegistrationQuality


@dataclass(frozen=True, slots=True)
class RegistrationRefused:
    """The guide was not found, or not surely."""

    image_id: str
    reason: str


@dataclass(frozen=True, slots=True)
class Reasoned:
    """A request or fact of which only the reason matters (empty = none given)."""

    reason: str


@dataclass(frozen=True, slots=True)
class TargetConfirmed:
    """The surgeon saw the server draw the target back and confirmed it (H08)."""

    target_id: str
    image_id: str
    registration_id: str
    echo_seen: bool | None
    overrides: tuple[Override, ...] = ()


@dataclass(frozen=True, slots=True)
class PlanRequested:
    """A path that was checked by the robot package (H11, H12), and what it was made from."""

    plan_id: str
    kind: PlanKind
    axial: bool
    made_from: tuple[str, ...]
    start_joints_rad: tuple[float, ...]
    length_mm: float
    rotation_rad: float
    speed_mm_s: float
    speed_rad_s: float
    acceleration_mm_s2: float
    # The smallest on the path (H11), and the clearance from what is in the room against what was asked for (H12).
    joint_margin_rad: float | None
    smallest_singular_value: float | None
    clearance_mm: float | None
    clearance_needed_mm: float | None
    # Predicted at the target (95 %); a plan of another kind aims at nothing.
    predicted_angle_rad: float | None
    predicted_position_mm: float | None
    overrides: tuple[Override, ...] = ()


@dataclass(frozen=True, slots=True)
class MoveApproved:
    """The surgeon approves one plan."""

    permit_id: str
    plan_id: str
    approval: Approval
    overrides: tuple[Override, ...] = ()  # bound to the permit


@dataclass(frozen=True, slots=True)
class MoveStarted:
    """The button is held: the permit is used."""

    motion_id: str
    permit_id: str
    control_token: int


@dataclass(frozen=True, slots=True)
class MotionEnded:
    """How a motion ended, and how far from its goal (arrived, missed, released)."""

    motion_id: str
    at_rest: bool | None
    distance_mm: float | None
    angle_rad: float | None


@dataclass(frozen=True, slots=True)
class Evaluated:
    """A verification image was evaluated both ways and held against the image before; bounds are 95 %, of contour."""

    evaluation_id: str
    image_id: str
    angle_error_rad: float | None
    angle_bound_rad: float | None
    position_error_mm: float | None
    position_bound_mm: float | None
    agree: bool | None  # paper and contour within their bounds (H33)
    motion_chi_square: float | None  # of the rings' motion against the arm's (H03)
    anatomy_across_mm: float | None  # shift of the anatomy between the images, at the target's depth (H34)
    anatomy_along_mm: float | None


@dataclass(frozen=True, slots=True)
class VerificationRefused:
    """A verification image could not be evaluated."""

    image_id: str
    reason: str


@dataclass(frozen=True, slots=True)
class CorrectionRequested:
    """The verification image becomes image and registration of a corrective move; the target crosses as a raw pixel."""

    image_id: str
    registration_id: str
    target_id: str
    quality: RegistrationQuality
    reason: str
    overrides: tuple[Override, ...] = ()


@dataclass(frozen=True, slots=True)
class InsertionStarted:
    """The surgeon is about to push the sleeve through the guide."""

    insertion_id: str
    approval: Approval


@dataclass(frozen=True, slots=True)
class SleeveIn:
    """A person says that the sleeve is in; the id is used if no insertion was open."""

    insertion_id: str


@dataclass(frozen=True, slots=True)
class GuideStated:
    """What a person says is in the guide's bore (sleeve_removed, guide_state_stated)."""

    guide: GuideState


@dataclass(frozen=True, slots=True)
class TargetDone:
    """The attempt is over: placed, or abandoned with a reason."""

    placed: bool
    reason: str


@dataclass(frozen=True, slots=True)
class Movement:
    """Something moved or was changed; `observed` by a machine, or stated by a person."""

    observed: bool
    what: str


@dataclass(frozen=True, slots=True)
class Stopped:
    """Who pressed stop, whatever their session."""

    person_id: str


class FaultKind(StrEnum):
    """Why the guard or the controller stopped the arm."""

    PROTECTIVE_STOP = "protective_stop"
    SAFEGUARD_STOP = "safeguard_stop"
    EMERGENCY_STOP = "emergency_stop"
    HEARTBEAT_LOST = "heartbeat_lost"
    SESSION_OVER = "session_over"  # whoever held the button was signed out, locked or disabled amid the motion
    GUARD_LOST = "guard_lost"
    FEEDBACK_LOST = "feedback_lost"
    SAFETY_FAULT = "safety_fault"  # the controller's own fault or violation
    ARM_OFF = "arm_off"
    FORCE_RISE = "force_rise"  # something pressed against the guide
    INSTALLATION_CHANGED = "installation_changed"  # TCP or payload, at the pendant, amid a motion
    MOTION_FAULT = "motion_fault"  # commanded, and not done as commanded
    PROGRAM_STARTED = "program_started"  # on the controller, by somebody else, while a sleeve was in


@dataclass(frozen=True, slots=True)
class Faulted:
    """A fault, seen from the safety bits or the guard."""

    kind: FaultKind


@dataclass(frozen=True, slots=True)
class Restarted:
    """The service started again with this case open."""


@dataclass(frozen=True, slots=True)
class Acknowledged:
    """A surgeon looked: what is in the guide now; must agree with what the case was told."""

    surgeon: bool
    guide: GuideState


@dataclass(frozen=True, slots=True)
class LeaseTaken:
    """Control goes to the person who asks, under a new fencing token."""

    control_token: int
    reason: str


@dataclass(frozen=True, slots=True)
class CaseClosed:
    """The end: how many targets are neither placed nor abandoned with a reason."""

    open_targets: int


@dataclass(frozen=True, slots=True)
class Paper:
    """Note, label, read, export: permitted to this role or not."""

    permitted: bool


Facts = (
    CarmPositionConfirmed
    | ExposureRequested
    | ImageArrived
    | NewestImageReused
    | RegistrationCompleted
    | RegistrationRefused
    | Reasoned
    | TargetConfirmed
    | PlanRequested
    | MoveApproved
    | MoveStarted
    | MotionEnded
    | Evaluated
    | VerificationRefused
    | CorrectionRequested
    | InsertionStarted
    | SleeveIn
    | GuideStated
    | TargetDone
    | Movement
    | Stopped
    | Faulted
    | Restarted
    | Acknowledged
    | LeaseTaken
    | CaseClosed
    | Paper
)

FACTS_OF: dict[Trigger, type[Facts]] = {
    Trigger.CARM_POSITION_CONFIRMED: CarmPositionConfirmed,
    Trigger.EXPOSURE_REQUESTED: ExposureRequested,
    Trigger.IMAGE_ARRIVED: ImageArrived,
    Trigger.NEWEST_IMAGE_REUSED: NewestImageReused,
    Trigger.REGISTRATION_COMPLETED: RegistrationCompleted,
    Trigger.REGISTRATION_REFUSED: RegistrationRefused,
    Trigger.RETAKE: Reasoned,
    Trigger.TARGET_CONFIRMED: TargetConfirmed,
    Trigger.TARGET_WITHDRAWN: Reasoned,
    Trigger.PLAN_REQUESTED: PlanRequested,
    Trigger.MOVE_APPROVED: MoveApproved,
    Trigger.MOVE_STARTED: MoveStarted,
    Trigger.ARRIVED: MotionEnded,
    Trigger.MISSED: MotionEnded,
    Trigger.RELEASED: MotionEnded,
    Trigger.VERIFICATION_PASSED: Evaluated,
    Trigger.VERIFICATION_FAILED: Evaluated,
    Trigger.VERIFICATION_REFUSED: VerificationRefused,
    Trigger.CORRECTION_REQUESTED: CorrectionRequested,
    Trigger.VERIFICATION_REJECTED: Reasoned,
    Trigger.INSERTION_STARTED: InsertionStarted,
    Trigger.SLEEVE_IN: SleeveIn,
    Trigger.INSERTION_CANCELLED: Reasoned,
    Trigger.SLEEVE_REMOVED: GuideStated,
    Trigger.TARGET_DONE: TargetDone,
    Trigger.GUIDE_STATE_STATED: GuideStated,
    Trigger.CARM_MOVED: Movement,
    Trigger.PATIENT_MOVED: Movement,
    Trigger.ARM_DISTURBED: Movement,
    Trigger.HAND_GUIDED: Movement,
    Trigger.DEVICE_CHANGED: Movement,
    Trigger.STOP: Stopped,
    Trigger.FAULT: Faulted,
    Trigger.RESTARTED: Restarted,
    Trigger.HOLD_REQUESTED: Reasoned,
    Trigger.ACKNOWLEDGED: Acknowledged,
    Trigger.LEASE_TAKEN: LeaseTaken,
    Trigger.CASE_CLOSED: CaseClosed,
    Trigger.CASE_ABORTED: Reasoned,
    Trigger.NOTE: Paper,
    Trigger.LABEL: Paper,
    Trigger.READ: Paper,
    Trigger.EXPORT: Paper,
}

# What may bring overrides with it.
OVERRIDING = (TargetConfirmed, CorrectionRequested, PlanRequested, MoveApproved)

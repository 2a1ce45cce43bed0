"""Every error that a caller can meet: stable code, HTTP status, what to do. No other module knows a status."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Any, Protocol


class ErrorCode(StrEnum):
    """Codes of the service itself; `vision`, `workflow` and `robot` have their own."""

    MALFORMED_REQUEST = "malformed_request"
    UNKNOWN_PATH = "unknown_path"
    METHOD_NOT_ALLOWED = "method_not_allowed"
    REQUEST_REFUSED = "request_refused"
    BODY_TOO_LARGE = "body_too_large"
    INTERNAL_FAULT = "internal_fault"
    NOT_READY = "not_ready"
    SETTINGS_REFUSED = "settings_refused"
    NOT_SIGNED_IN = "not_signed_in"
    SIGN_IN_REFUSED = "sign_in_refused"
    SESSION_EXPIRED = "session_expired"
    SESSION_LOCKED = "session_locked"
    LOCKED_OUT = "locked_out"
    SIGN_IN_BUSY = "sign_in_busy"
    PERMISSION_MISSING = "permission_missing"
    PIN_REFUSED = "pin_refused"
    ORIGIN_REFUSED = "origin_refused"
    USER_EXISTS = "user_exists"
    USER_REFUSED = "user_refused"
    USER_UNKNOWN = "user_unknown"
    LEASE_MISSING = "lease_missing"
    LEASE_LOST = "lease_lost"
    CASE_UNKNOWN = "case_unknown"
    CASE_OPEN = "case_open"
    CASE_ELSEWHERE = "case_elsewhere"
    TOO_FEW_CASES = "too_few_cases"
    ARTEFACT_UNKNOWN = "artefact_unknown"
    VERSION_MISSING = "version_missing"
    VERSION_STALE = "version_stale"
    IDEMPOTENCY_KEY_MISSING = "idempotency_key_missing"
    IDEMPOTENCY_KEY_REUSED = "idempotency_key_reused"
    PLANNED_TARGET_UNKNOWN = "planned_target_unknown"
    IMAGE_NOT_REGISTERED = "image_not_registered"
    EXPOSURE_POSE_UNKNOWN = "exposure_pose_unknown"
    EVALUATIONS_DISAGREE = "evaluations_disagree"
    EVALUATIONS_DISAGREE_AGAIN = "evaluations_disagree_again"
    ARM_UNKNOWN = "arm_unknown"
    NUDGE_TOO_SHORT = "nudge_too_short"
    CHECK_UNKNOWN = "check_unknown"
    IMAGE_UNKNOWN = "image_unknown"
    FINDINGS_UNKNOWN = "findings_unknown"
    IMAGE_BYTES_TOO_LARGE = "image_bytes_too_large"
    IMAGE_TRUNCATED = "image_truncated"
    IMAGE_TOO_SMALL = "image_too_small"
    NOT_AN_IMAGE = "not_an_image"
    SEVERAL_FRAMES = "several_frames"
    IMAGE_UID_TAKEN = "image_uid_taken"
    MEDIA_TYPE_UNKNOWN = "media_type_unknown"
    PURPOSE_UNDECIDED = "purpose_undecided"
    PURPOSE_REFUSED = "purpose_refused"
    PATIENT_DIFFERS = "patient_differs"
    IMAGE_NAMED = "image_named"
    IMAGE_TAKEN_IN = "image_taken_in"
    STATEMENT_OUTDATED = "statement_outdated"
    DEVICE_UNKNOWN = "device_unknown"
    DEVICE_REFUSED = "device_refused"
    DEVICE_VERSION_TAKEN = "device_version_taken"
    DEVICE_EXPIRED = "device_expired"
    DISK_FULL = "disk_full"
    DATABASE_FAULT = "database_fault"
    DATABASE_MISSING = "database_missing"
    DATABASE_BUSY = "database_busy"
    SCHEMA_UNKNOWN = "schema_unknown"
    SCHEMA_OLD = "schema_old"
    BACKUP_REFUSED = "backup_refused"
    LEDGER_BROKEN = "ledger_broken"
    KEY_REFUSED = "key_refused"
    KEY_MISSING = "key_missing"
    ROOM_CLAIMED = "room_claimed"
    EXTRA_MISSING = "extra_missing"
    PEER_UNREACHABLE = "peer_unreachable"
    PEER_UNKNOWN = "peer_unknown"
    ROOM_LEFT = "room_left"
    CLUSTER_UNAVAILABLE = "cluster_unavailable"
    ARCHIVE_REFUSED = "archive_refused"
    CASE_DIFFERS = "case_differs"
    MARKUPS_REFUSED = "markups_refused"
    VISION_DEADLINE = "vision_deadline"
    VISION_CRASHED = "vision_crashed"
    VISION_OUT_OF_MEMORY = "vision_out_of_memory"


class ServiceError(Exception):
    """A typed no that reaches the caller as problem+json."""

    def __init__(
        self,
        code: str,
        message: str,
        *,
        measured: float | str | bool | None = None,
        limit: float | str | bool | None = None,
        leads_onwards: Sequence[str] = (),
        verdicts: Sequence[Mapping[str, Any]] = (),
    ) -> None:
        super().__init__(f"{code}: {message}")
        self.code = str(code)
        self.message = message
        self.measured = measured
        self.limit = limit
        self.leads_onwards = tuple(leads_onwards)
        self.verdicts = tuple(dict(verdict) for verdict in verdicts)


class AnyRefusal(Protocol):
    """What the refusals of `vision`, `workflow` and `robot` have in common."""

    @property
    def code(self) -> StrEnum: ...
    @property
    def message(self) -> str: ...


def refused(refusal: AnyRefusal) -> ServiceError:
    """A refusal of another package as the error that the caller sees, with whatever it measured."""
    return ServiceError(
        refusal.code,
        refusal.message,
        measured=getattr(refusal, "measured", None),
        limit=getattr(refusal, "limit", None),
        leads_onwards=[str(trigger) for trigger in getattr(refusal, "leads_onwards", ())],
    )


@dataclass(frozen=True, slots=True)
class Answer:
    """How one code is answered: HTTP status and the sentence that tells the caller what to do."""

    status: int
    what_to_do: str


ANSWERS: dict[str, Answer] = {
    ErrorCode.MALFORMED_REQUEST: Answer(422, "Correct the fields that the answer names, then send the request again."),
    ErrorCode.UNKNOWN_PATH: Answer(404, "Check the address against the interface description at /api/openapi.json."),
    ErrorCode.METHOD_NOT_ALLOWED: Answer(405, "Use one of the methods that the Allow header names."),
    ErrorCode.REQUEST_REFUSED: Answer(400, "Check the request against the interface description."),
    ErrorCode.BODY_TOO_LARGE: Answer(413, "Send less; the limit is in the answer."),
    ErrorCode.INTERNAL_FAULT: Answer(500, "Look at the case before repeating; report the incident number."),
    ErrorCode.NOT_READY: Answer(503, "Run `coaxial doctor`: it says of each reason what to do. Stop still works."),
    ErrorCode.SETTINGS_REFUSED: Answer(500, "Correct the settings file or the environment variable, then start again."),
    ErrorCode.NOT_SIGNED_IN: Answer(401, "Sign in."),
    ErrorCode.SIGN_IN_REFUSED: Answer(401, "Check name and password or PIN."),
    ErrorCode.SESSION_EXPIRED: Answer(401, "Sign in again; stop still works."),
    ErrorCode.SESSION_LOCKED: Answer(401, "Unlock with the PIN; stop still works."),
    ErrorCode.LOCKED_OUT: Answer(429, "Wait until the time in the answer has passed, or ask an engineer."),
    ErrorCode.SIGN_IN_BUSY: Answer(503, "Try again in a moment."),
    ErrorCode.PERMISSION_MISSING: Answer(403, "Ask someone whose role has this permission."),
    ErrorCode.PIN_REFUSED: Answer(403, "Enter the PIN again."),
    ErrorCode.ORIGIN_REFUSED: Answer(403, "Open the page from the service itself, or name its origin in the settings."),
    ErrorCode.USER_EXISTS: Answer(409, "Choose another name."),
    ErrorCode.USER_REFUSED: Answer(422, "Choose a name, password or PIN that meets the rule."),
    ErrorCode.USER_UNKNOWN: Answer(404, "Check the name."),
    ErrorCode.LEASE_MISSING: Answer(409, "Take the control lease first, with a reason."),
    ErrorCode.LEASE_LOST: Answer(409, "Somebody else has taken control; take it back only after talking to them."),
    ErrorCode.CASE_UNKNOWN: Answer(404, "Choose a case from the list."),
    ErrorCode.CASE_OPEN: Answer(409, "Close or abort the open case of this room first."),
    ErrorCode.TOO_FEW_CASES: Answer(409, "Wait for more cases: from so few, chance and drift look alike."),
    ErrorCode.CASE_ELSEWHERE: Answer(409, "Ask the service of the room that the answer names."),
    ErrorCode.ARTEFACT_UNKNOWN: Answer(404, "Read the case again; its chain names what exists."),
    ErrorCode.VERSION_MISSING: Answer(428, "Send If-Match with the version that the decision was made on."),
    ErrorCode.VERSION_STALE: Answer(412, "Read the case again, look at what changed, then decide anew."),
    ErrorCode.IDEMPOTENCY_KEY_MISSING: Answer(400, "Send an Idempotency-Key that is new for every intent."),
    ErrorCode.IDEMPOTENCY_KEY_REUSED: Answer(422, "Use a new Idempotency-Key for a different request."),
    ErrorCode.PLANNED_TARGET_UNKNOWN: Answer(404, "Choose one of the case's planned targets, or none."),
    ErrorCode.IMAGE_NOT_REGISTERED: Answer(409, "Pick the target in the registered image that the status names."),
    ErrorCode.EXPOSURE_POSE_UNKNOWN: Answer(409, "Request an exposure and take a new image."),
    ErrorCode.EVALUATIONS_DISAGREE: Answer(
        422, "Expose once more. If they disagree again, register anew: exposing alone gets no further."
    ),
    ErrorCode.EVALUATIONS_DISAGREE_AGAIN: Answer(
        422,
        "Withdraw the target, take another image and register where the guide is now, choose the target in it and move."
        " If they disagree after that, too, have an engineer make the daily check and hold the guide against its file.",
    ),
    ErrorCode.ARM_UNKNOWN: Answer(409, "Connect the arm, switch it on, and wait until the status shows it."),
    ErrorCode.NUDGE_TOO_SHORT: Answer(422, "Plan a nudge of 5 mm or more along the guide's own y."),
    ErrorCode.CHECK_UNKNOWN: Answer(404, "Begin the daily check, then take a new image."),
    ErrorCode.IMAGE_UNKNOWN: Answer(404, "Choose an image from the list."),
    ErrorCode.FINDINGS_UNKNOWN: Answer(404, "Choose an image whose registration or verification was refused."),
    ErrorCode.IMAGE_BYTES_TOO_LARGE: Answer(413, "Send a single frame below the limit in the answer."),
    ErrorCode.IMAGE_TRUNCATED: Answer(422, "Send the image again from the C-arm."),
    ErrorCode.IMAGE_TOO_SMALL: Answer(422, "Send the full image, not a thumbnail."),
    ErrorCode.NOT_AN_IMAGE: Answer(422, "Send an X-ray image with pixel data."),
    ErrorCode.SEVERAL_FRAMES: Answer(422, "Send the last image of the run as a single frame."),
    ErrorCode.IMAGE_UID_TAKEN: Answer(409, "Give each image a SOP instance UID of its own, then send it again."),
    ErrorCode.MEDIA_TYPE_UNKNOWN: Answer(415, "Send DICOM, PNG or TIFF, and say which in Content-Type."),
    ErrorCode.PURPOSE_UNDECIDED: Answer(409, "State first whose image it is, or wait until it has been taken in."),
    ErrorCode.PURPOSE_REFUSED: Answer(
        409,
        "Say what the answer allows; for a registration or a verification request an exposure and take a new image.",
    ),
    ErrorCode.PATIENT_DIFFERS: Answer(409, "Look at whose image and whose case this is, then decide anew."),
    ErrorCode.IMAGE_NAMED: Answer(409, "Nothing: the image says itself whose it is."),
    ErrorCode.IMAGE_TAKEN_IN: Answer(409, "Read the case again; what became of the image is in its events."),
    ErrorCode.STATEMENT_OUTDATED: Answer(409, "Look at view and exposure of the case as it is now, then state anew."),
    ErrorCode.DEVICE_UNKNOWN: Answer(404, "Upload the device file first."),
    ErrorCode.DEVICE_REFUSED: Answer(422, "Correct the line that the message names; check its unit."),
    ErrorCode.DEVICE_VERSION_TAKEN: Answer(409, "Raise the version in the file; a stored version is never replaced."),
    ErrorCode.DEVICE_EXPIRED: Answer(409, "Calibrate the device and upload its new file."),
    ErrorCode.DISK_FULL: Answer(507, "Free space on the data folder's disk; stop still works."),
    ErrorCode.DATABASE_FAULT: Answer(503, "Check the disk and the database; nothing was changed. Stop still works."),
    ErrorCode.DATABASE_MISSING: Answer(
        503,
        "Name the folder with --data-folder or --config; a new record begins with its first user, `coaxial user add`.",
    ),
    ErrorCode.DATABASE_BUSY: Answer(503, "Try again in a moment; nothing was changed."),
    ErrorCode.SCHEMA_UNKNOWN: Answer(503, "Start the version that wrote the database, or a newer one."),
    ErrorCode.SCHEMA_OLD: Answer(
        503, "Back up, then run `coaxial db upgrade`; on PostgreSQL as the owner, with --role for the service's role."
    ),
    ErrorCode.BACKUP_REFUSED: Answer(
        409,
        "Name a new file to back up to, and an empty database to restore into; PostgreSQL needs its client programs.",
    ),
    ErrorCode.LEDGER_BROKEN: Answer(
        503, "Run `coaxial audit verify` and keep the database as it is; stop still works."
    ),
    ErrorCode.KEY_REFUSED: Answer(
        500, "Name the right file, and give a private key to the service's user alone (mode 0600)."
    ),
    ErrorCode.KEY_MISSING: Answer(
        500,
        "Bring that file and its .pub back from where the record was signed; if they are lost, or this workstation"
        " is new to the record, `coaxial audit key --new` makes a key: it vouches for what follows, not for the past.",
    ),
    ErrorCode.ROOM_CLAIMED: Answer(409, "Stop the other service of this room, or give this one a room of its own."),
    ErrorCode.PEER_UNREACHABLE: Answer(502, "Check the peer's address and AE title in the settings, and its own log."),
    ErrorCode.PEER_UNKNOWN: Answer(404, "Name the peer's host in the settings; until then enter the data by hand."),
    ErrorCode.EXTRA_MISSING: Answer(501, "Install the program with the extra that the answer names."),
    ErrorCode.ROOM_LEFT: Answer(
        409, "If that workstation is dead, start with `coaxial serve --claim-room REASON`; else end its service first."
    ),
    ErrorCode.CLUSTER_UNAVAILABLE: Answer(503, "Start the scheduler and its workers, or replay on this machine."),
    ErrorCode.ARCHIVE_REFUSED: Answer(422, "Verify the file (`coaxial case verify`); get it again from its maker."),
    ErrorCode.CASE_DIFFERS: Answer(409, "Keep both: this database and the file. Compare them with `coaxial audit`."),
    ErrorCode.MARKUPS_REFUSED: Answer(
        422, "Save the lines from 3D Slicer again, one per pedicle, entry first; or enter the targets by hand."
    ),
    ErrorCode.VISION_DEADLINE: Answer(503, "Try again; if it repeats, take a new image."),
    ErrorCode.VISION_CRASHED: Answer(503, "Try again; the image worker was restarted."),
    ErrorCode.VISION_OUT_OF_MEMORY: Answer(503, "Take a smaller image, or raise the memory limit in the settings."),
    # vision
    "no_guide_found": Answer(422, "Bring the guide into the image, then expose again."),
    "guide_cut_off": Answer(422, "Bring both rings and the line fully into the image, then expose again."),
    "ring_missing": Answer(422, "Check that nothing covers the rings, then expose again."),
    "line_missing": Answer(422, "Check that nothing covers the indicator line, then expose again."),
    "bead_missing": Answer(
        422, "Turn the C-arm or the guide so that the bead is clear of the rings, then expose again."
    ),
    "mirrored": Answer(422, "Switch off the C-arm's image flip, then expose again."),
    "handedness_unproved": Answer(
        422, "Nudge the guide by 5 mm or more along its y with the C-arm at rest, then expose again."
    ),
    "plate_missing": Answer(422, "Mount the correction plate, then expose again."),
    "plate_too_sparse": Answer(422, "Uncover the correction plate, then expose again."),
    "plate_unexpected": Answer(422, "Choose the C-arm file of this detector, with its plate, or take the plate off."),
    "scale_mismatch": Answer(422, "Check that the C-arm file belongs to this C-arm and the image was not scaled."),
    "residual_too_high": Answer(422, "Hold everything still and expose again; check that the guide is not bent."),
    "predicted_error_too_high": Answer(422, "Choose a view in which the rings appear larger and further apart."),
    "guide_mismatch": Answer(422, "Check that the guide file belongs to the mounted guide."),
    "ambiguous": Answer(422, "Remove other ring-like instruments from the view, then expose again."),
    "unreadable_image": Answer(422, "Send the image again from the C-arm."),
    "unsupported_image": Answer(422, "Send a single-frame grey-scale X-ray image."),
    "image_too_large": Answer(413, "Send a single frame below the limit in the answer."),
    "target_not_finite": Answer(422, "Pick the target in the image."),
    "target_outside_image": Answer(422, "Pick the target inside the image."),
    "target_not_reachable": Answer(422, "Choose a view in which the target lies nearer to the guide's axis."),
    "path_implausible": Answer(422, "Check the planned points and their unit, mm."),
    # workflow
    "case_over": Answer(409, "Open a new case."),
    "held": Answer(409, "Remove the cause, then acknowledge."),
    "arm_moving": Answer(409, "Release the button, or stop."),
    "instrument_in_guide": Answer(409, "Empty the guide, then say so."),
    "insertion_running": Answer(409, "State that the sleeve is in, or that the insertion is cancelled."),
    "missing": Answer(409, "Do first what the answer names under leads_onwards."),
    "not_now": Answer(409, "Do first what the answer names under leads_onwards."),
    "reason_required": Answer(422, "Give a reason."),
    "role": Answer(403, "Ask someone whose role allows it."),
    "targets_open": Answer(409, "Place each planned target or abandon it with a reason."),
    "not_overridable": Answer(409, "Leave the override out: this interlock never yields; remove its cause."),
    "interlock": Answer(409, "Remove what each failed verdict names, then ask again."),
    # robot
    "goal_unreachable": Answer(409, "Move the base or the C-arm, or choose another view."),
    "joint_limit": Answer(409, "Approach from another arm pose."),
    "near_singularity": Answer(409, "Approach from another arm pose."),
    "joint_jump": Answer(409, "Approach from another arm pose."),
    "joint_speed": Answer(409, "Approach from another arm pose."),
    "path_too_long": Answer(409, "Go in several motions, each planned and approved, or bring the guide nearer first."),
    "model_mismatch": Answer(409, "Check the arm's model and its calibration."),
    "keep_out": Answer(409, "Go another way, or correct the room file if nothing is there."),
    "too_few_poses": Answer(422, "Record more poses of the arm, each with an image of the guide."),
    "poses_too_alike": Answer(422, "Record poses that turn the guide about two axes by 15 deg and more."),
    "poses_inconsistent": Answer(422, "Leave out the pose that is named, or record it anew with the arm at rest."),
    "guard_held": Answer(409, "Acknowledge the stop first."),
    "motion_running": Answer(409, "Wait for the end of the motion, or stop."),
    "permit_reused": Answer(409, "Plan and approve anew."),
    "no_live_heartbeat": Answer(409, "Hold the button on a live connection."),
    "feedback_late": Answer(
        409, "See what keeps packets back between the controller and this machine: switch, cable, load."
    ),
    "arm_unreachable": Answer(409, "Check power and network of the arm and its address in the settings."),
    "arm_not_ready": Answer(409, "Switch the arm on, release the brakes, clear any stop at the pendant."),
    "arm_not_at_rest": Answer(409, "Wait until the arm is at rest."),
    "arm_moved_since_permit": Answer(409, "Plan and approve anew from where the arm is."),
    "tcp_mismatch": Answer(409, "Set the controller's TCP as the tool file has it."),
    "payload_mismatch": Answer(409, "Set the controller's payload as the tool file has it."),
    "force_at_rest": Answer(
        409, "See what presses or pulls at the guide or the arm, and that nothing else is mounted."
    ),
    "speed_above_cap": Answer(409, "Plan with a lower speed."),
    "acceleration_above_cap": Answer(409, "Plan with a lower acceleration."),
    "move_too_far": Answer(409, "Go in several motions, each planned and approved."),
    "stopped": Answer(409, "Plan and approve anew."),
    "journal_unwritable": Answer(507, "Free space on the data folder's disk; stop still works."),
    "arm_claimed": Answer(409, "End the other service that runs this arm, or give this one an arm of its own."),
    "controller_refused": Answer(409, "Look at the controller's message on the pendant."),
    "robot_fault": Answer(503, "Look at the arm; stop still works."),
    "guard_down": Answer(503, "Start the service again; no motion is possible before."),
    "guard_message_invalid": Answer(503, "Start the service again; no motion is possible before."),
}


def answer_for(code: str) -> Answer:
    """How `code` is answered; an unlisted code is a defect that a test finds, and answers as an internal fault."""
    return ANSWERS.get(code, ANSWERS[ErrorCode.INTERNAL_FAULT])


def code_for_status(status: int) -> ErrorCode:
    """The code for an error that the web framework raised by itself, known only by its status."""
    match status:
        case 404:
            return ErrorCode.UNKNOWN_PATH
        case 405:
            return ErrorCode.METHOD_NOT_ALLOWED
        case 413:
            return ErrorCode.BODY_TOO_LARGE
        case status if status < 500:
            return ErrorCode.REQUEST_REFUSED
        case _:
            return ErrorCode.INTERNAL_FAULT

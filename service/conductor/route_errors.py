"""The error codes of the conductor's routes, for the interface description."""

from robot.refusal import RefusalCode as PathRefusal
from service.errors import ErrorCode
from service.openapi import may_fail_with
from vision.refusal import RefusalCode as ImageRefusal
from workflow.refusals import RefusalCode

_FACT = (ErrorCode.CASE_UNKNOWN, ErrorCode.IDEMPOTENCY_KEY_REUSED)
_REQUEST = (
    *_FACT,
    ErrorCode.VERSION_MISSING,
    ErrorCode.VERSION_STALE,
    ErrorCode.IDEMPOTENCY_KEY_MISSING,
    *RefusalCode,
)
_LEASE = (ErrorCode.LEASE_MISSING, ErrorCode.LEASE_LOST)
_PIN = (ErrorCode.PIN_REFUSED, ErrorCode.LOCKED_OUT)
_VISION = (ErrorCode.VISION_DEADLINE, ErrorCode.VISION_CRASHED, ErrorCode.VISION_OUT_OF_MEMORY)
_PATH = (
    PathRefusal.GOAL_UNREACHABLE,
    PathRefusal.JOINT_LIMIT,
    PathRefusal.NEAR_SINGULARITY,
    PathRefusal.JOINT_JUMP,
    PathRefusal.JOINT_SPEED,
    PathRefusal.PATH_TOO_LONG,
    PathRefusal.MODEL_MISMATCH,
    PathRefusal.KEEP_OUT,
)
_TARGET = (ImageRefusal.TARGET_NOT_FINITE, ImageRefusal.TARGET_OUTSIDE_IMAGE, ImageRefusal.TARGET_NOT_REACHABLE)

READING = may_fail_with(ErrorCode.CASE_UNKNOWN)
STATING = may_fail_with(*_FACT)
STATING_ABOUT_A_FILE = may_fail_with(*_FACT, ErrorCode.DEVICE_UNKNOWN, ErrorCode.DEVICE_REFUSED)
STATING_ABOUT_AN_IMAGE = may_fail_with(*_FACT, ErrorCode.IMAGE_UNKNOWN)
STATING_AN_IDENTITY = may_fail_with(
    ErrorCode.CASE_UNKNOWN,
    ErrorCode.IMAGE_UNKNOWN,
    ErrorCode.IMAGE_NAMED,
    ErrorCode.IMAGE_TAKEN_IN,
    ErrorCode.STATEMENT_OUTDATED,
    ErrorCode.PURPOSE_REFUSED,
)
ASSIGNING_AN_IMAGE = may_fail_with(
    *_FACT,
    ErrorCode.IMAGE_UNKNOWN,
    ErrorCode.PURPOSE_UNDECIDED,
    ErrorCode.PURPOSE_REFUSED,
    ErrorCode.IMAGE_TAKEN_IN,
    ErrorCode.PATIENT_DIFFERS,
    ErrorCode.NOT_AN_IMAGE,
    ErrorCode.IMAGE_BYTES_TOO_LARGE,
    ErrorCode.IMAGE_TOO_SMALL,
    ErrorCode.IMAGE_TRUNCATED,
    ErrorCode.SEVERAL_FRAMES,
    RefusalCode.REASON_REQUIRED,
    RefusalCode.INTERLOCK,
)
REQUESTING = may_fail_with(*_REQUEST)
REUSING_AN_IMAGE = may_fail_with(*_REQUEST, ErrorCode.IMAGE_UNKNOWN, *_VISION)
CLOSING = may_fail_with(*_REQUEST, *_PIN)
DRAWING_BACK = may_fail_with(ErrorCode.CASE_UNKNOWN, ErrorCode.IMAGE_NOT_REGISTERED, *_TARGET, *_VISION)
AIMING = may_fail_with(*_REQUEST, *_LEASE, ErrorCode.PLANNED_TARGET_UNKNOWN, *_TARGET, *_VISION)
PLANNING = may_fail_with(
    *_REQUEST,
    *_LEASE,
    ErrorCode.ARM_UNKNOWN,
    ErrorCode.NUDGE_TOO_SHORT,
    ErrorCode.EXPOSURE_POSE_UNKNOWN,
    ErrorCode.DEVICE_UNKNOWN,
    *_PATH,
)
APPROVING = may_fail_with(*_REQUEST, *_LEASE, *_PIN)
OVERLAYS = may_fail_with(ErrorCode.IMAGE_UNKNOWN, ErrorCode.IMAGE_NOT_REGISTERED, *_TARGET, *_VISION)
ANGLES = may_fail_with(ErrorCode.CASE_UNKNOWN, ErrorCode.PLANNED_TARGET_UNKNOWN, *_VISION)

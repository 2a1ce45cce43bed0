"""Everything that can happen to a case, and who speaks."""

from enum import StrEnum


class Kind(StrEnum):
    """Requests may be refused; observations and facts never are."""

    REQUEST = "q"
    OBSERVATION = "o"
    FACT = "f"


class Trigger(StrEnum):
    """What happened or is asked for; the names say who speaks."""

    CARM_POSITION_CONFIRMED = "carm_position_confirmed"
    EXPOSURE_REQUESTED = "exposure_requested"
    IMAGE_ARRIVED = "image_arrived"
    NEWEST_IMAGE_REUSED = "newest_image_reused"
    REGISTRATION_COMPLETED = "registration_completed"
    REGISTRATION_REFUSED = "registration_refused"
    RETAKE = "retake"
    TARGET_CONFIRMED = "target_confirmed"
    TARGET_WITHDRAWN = "target_withdrawn"
    PLAN_REQUESTED = "plan_requested"
    MOVE_APPROVED = "move_approved"
    MOVE_STARTED = "move_started"
    ARRIVED = "arrived"
    MISSED = "missed"
    RELEASED = "released"
    VERIFICATION_PASSED = "verification_passed"
    VERIFICATION_FAILED = "verification_failed"
    VERIFICATION_REFUSED = "verification_refused"
    CORRECTION_REQUESTED = "correction_requested"
    VERIFICATION_REJECTED = "verification_rejected"
    INSERTION_STARTED = "insertion_started"
    SLEEVE_IN = "sleeve_in"
    INSERTION_CANCELLED = "insertion_cancelled"
    SLEEVE_REMOVED = "sleeve_removed"
    TARGET_DONE = "target_done"
    GUIDE_STATE_STATED = "guide_state_stated"
    CARM_MOVED = "carm_moved"
    PATIENT_MOVED = "patient_moved"
    ARM_DISTURBED = "arm_disturbed"
    HAND_GUIDED = "hand_guided"
    DEVICE_CHANGED = "device_changed"
    STOP = "stop"
    FAULT = "fault"
    RESTARTED = "restarted"
    HOLD_REQUESTED = "hold_requested"
    ACKNOWLEDGED = "acknowledged"
    LEASE_TAKEN = "lease_taken"
    CASE_CLOSED = "case_closed"
    CASE_ABORTED = "case_aborted"
    NOTE = "note"
    LABEL = "label"
    READ = "read"
    EXPORT = "export"

    @property
    def kind(self) -> Kind:
        """Who speaks: a request, the machine's observation or a person's fact."""
        if self in _OBSERVATIONS:
            return Kind.OBSERVATION
        return Kind.FACT if self in _FACTS else Kind.REQUEST


_OBSERVATIONS = frozenset(
    {
        Trigger.IMAGE_ARRIVED,
        Trigger.REGISTRATION_COMPLETED,
        Trigger.REGISTRATION_REFUSED,
        Trigger.ARRIVED,
        Trigger.MISSED,
        Trigger.RELEASED,
        Trigger.VERIFICATION_PASSED,
        Trigger.VERIFICATION_FAILED,
        Trigger.VERIFICATION_REFUSED,
        Trigger.ARM_DISTURBED,
        Trigger.FAULT,
        Trigger.RESTARTED,
    }
)
# The C-arm and the patient may also be seen to move (`facts.Movement.observed`); nobody may be refused either way.
_FACTS = frozenset(
    {
        Trigger.SLEEVE_IN,
        Trigger.INSERTION_CANCELLED,
        Trigger.SLEEVE_REMOVED,
        Trigger.GUIDE_STATE_STATED,
        Trigger.CARM_MOVED,
        Trigger.PATIENT_MOVED,
        Trigger.HAND_GUIDED,
        Trigger.DEVICE_CHANGED,
        Trigger.CASE_ABORTED,
    }
)
REQUESTS = tuple(trigger for trigger in Trigger if trigger.kind is Kind.REQUEST)

"""What a decision says: the case afterwards, and what the service has to do and to store."""

from dataclasses import dataclass
from enum import StrEnum

from workflow.case import CaseState
from workflow.triggers import Trigger
from workflow.verdicts import Verdict


class Outcome(StrEnum):
    """How the trigger was taken."""

    TAKEN = "taken"  # by a row of the table
    LATE = "late"  # an observation whose subject is no longer current
    RECORDED = "recorded"  # a fact that changes nothing here


class Effect(StrEnum):
    """What the service does besides storing the event."""

    STOP_SENT = "stop_sent"  # sent before anything is stored
    REGISTRATION_STARTS = "registration_starts"
    EVALUATION_STARTS = "evaluation_starts"
    ALARM = "alarm"
    CHECKPOINT_SIGNED = "checkpoint_signed"


class ImageUse(StrEnum):
    """What an image is for."""

    REGISTRATION = "registration"
    VERIFICATION = "verification"
    SCOUT = "scout"  # these two only by a person's word
    DEPTH_CHECK = "depth_check"
    UNASSIGNED = "unassigned"  # not asked for, late, or the arm moved
    QUARANTINED = "quarantined"  # another patient's, or seen before


@dataclass(frozen=True, slots=True)
class Decision:
    """An accepted request, a recorded observation or fact."""

    trigger: Trigger
    row: int | None  # of the table; None where no row lists it
    outcome: Outcome
    after: CaseState
    voided: tuple[str, ...]  # ids, oldest first
    effects: tuple[Effect, ...]
    verdicts: tuple[Verdict, ...]
    image_use: ImageUse | None  # of an arrived image
    taken_as: (
        Trigger  # another trigger's row where the checks say otherwise than the speaker (passed, but beyond limits)
    )


@dataclass(frozen=True, slots=True)
class Allowance:
    """Whether a request would be taken now, as far as can be told without what comes with it."""

    allowed: bool
    code: str | None  # of the refusal
    message: str
    reasons: tuple[Verdict, ...]  # the verdicts that refuse
    leads_onwards: tuple[Trigger, ...]

"""The state of a case: one frozen value that the service stores with every event."""

from dataclasses import dataclass

from workflow.links import Artefact, Link
from workflow.overrides import Override
from workflow.plans import PlanKind
from workflow.states import GuideState, InsertionStatus, State


@dataclass(frozen=True, slots=True)
class Plan:
    """A path that the robot package found passable, from these joints."""

    id: str
    made_from: tuple[str, ...]
    kind: PlanKind
    axial: bool  # a straight line along the guide's own axis, away from the patient
    start_joints_rad: tuple[float, ...]
    used: bool  # a motion was started from it; the next one starts from the live pose and a plan of its own
    predicted_angle_rad: float | None = None  # at the target, 95 %
    predicted_position_mm: float | None = None


@dataclass(frozen=True, slots=True)
class Permit:
    """A surgeon's approval of one plan: single use, and void when anything that it binds is another."""

    id: str
    made_from: tuple[str, ...]
    issued_s: float
    joints_rad: tuple[float, ...]
    devices_hash: str
    guide: GuideState
    control_token: int
    overrides: tuple[Override, ...] = ()  # good for the one motion of this permit


@dataclass(frozen=True, slots=True)
class Motion:
    """A motion under way, or the completed one that a verification can look at."""

    id: str
    made_from: tuple[str, ...]
    kind: PlanKind


@dataclass(frozen=True, slots=True)
class Verification:
    """The newest verdict on where the guide points."""

    id: str
    made_from: tuple[str, ...]
    image_id: str
    motion_id: str
    passed: bool
    judged_s: float


@dataclass(frozen=True, slots=True)
class Insertion:
    """The sleeve of the current attempt, beside the chain: only a person's fact changes it."""

    id: str
    status: InsertionStatus
    verified: bool
    flagged: bool  # something moved or changed while the sleeve was in


@dataclass(frozen=True, slots=True)
class Window:
    """A requested exposure: the one image that arrives in time enters the chain."""

    id: str
    opened_s: float
    joints_rad: tuple[float, ...]
    motion_id: str | None  # the completed motion that the image is to verify


@dataclass(frozen=True, slots=True)
class CaseState:
    """Everything that the rules know of a case; void links are None, their records stay in the database."""

    case_id: str
    state: State
    guide: GuideState
    view: Artefact | None
    image: Artefact | None
    registration: Artefact | None
    target: Artefact | None
    plan: Plan | None
    permit: Permit | None
    motion: Motion | None  # complete: arrived at its target
    verification: Verification | None
    running: Motion | None  # under way
    insertion: Insertion | None
    window: Window | None
    evaluated_image: Artefact | None  # arrived for verification, its evaluation not yet finished
    newest_image_id: str | None  # nothing has moved since it was taken
    used_permit_id: str | None  # the newest that was consumed (H14)
    held_for: str | None  # why the case is in safe_hold
    control_token: int | None  # of the lease that was last taken
    corrections: int  # of the current target
    images: int  # every image that arrived, whatever became of it

    def link(self, link: Link) -> Artefact | Plan | Permit | Motion | Verification | None:
        """The artefact at a place in the chain, or None where it is missing or void."""
        artefact: Artefact | Plan | Permit | Motion | Verification | None = getattr(self, link.value)
        return artefact


def opened(case_id: str) -> CaseState:
    """A new case: nothing made, nothing stated."""
    return CaseState(
        case_id=case_id,
        state=State.CASE_OPEN,
        guide=GuideState.UNKNOWN,
        view=None,
        image=None,
        registration=None,
        target=None,
        plan=None,
        permit=None,
        motion=None,
        verification=None,
        running=None,
        insertion=None,
        window=None,
        evaluated_image=None,
        newest_image_id=None,
        used_permit_id=None,
        held_for=None,
        control_token=None,
        corrections=0,
        images=0,
    )

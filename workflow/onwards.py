"""What leads onwards: for a request that is refused, the triggers that bring it nearer."""

from collections import deque
from functools import cache, lru_cache, reduce

from workflow.case import CaseState
from workflow.inquiry import Inquiry
from workflow.limits import Limits
from workflow.needs import MAKERS, first_missing
from workflow.rows import Goto, Row
from workflow.settling import settle
from workflow.snapshot import unknown_snapshot
from workflow.states import GuideState, InsertionStatus, State
from workflow.table import TABLE
from workflow.totality import listed
from workflow.triggers import Trigger

# Nobody should end a case, break something or claim a movement just to get on.
_NO_WAY_ON = frozenset(
    {
        Trigger.STOP,
        Trigger.FAULT,
        Trigger.RESTARTED,
        Trigger.CASE_CLOSED,
        Trigger.CASE_ABORTED,
        Trigger.PATIENT_MOVED,
        Trigger.ARM_DISTURBED,
        Trigger.HAND_GUIDED,
        Trigger.DEVICE_CHANGED,
        Trigger.REGISTRATION_REFUSED,
        Trigger.MISSED,
        Trigger.RELEASED,
    }
)


def from_the_guide(case: CaseState) -> tuple[Trigger, ...]:
    """How the guide becomes empty in the record: by a person's fact about what is in it."""
    if case.insertion is None:
        return (Trigger.GUIDE_STATE_STATED,)
    if case.insertion.status is InsertionStatus.OPEN:
        return (Trigger.INSERTION_CANCELLED, Trigger.SLEEVE_IN)
    return (Trigger.SLEEVE_REMOVED,)


def from_the_insertion(case: CaseState) -> tuple[Trigger, ...]:
    """How a running insertion ends."""
    if case.insertion is not None and case.insertion.status is InsertionStatus.OPEN:
        return (Trigger.SLEEVE_IN, Trigger.INSERTION_CANCELLED)
    if case.guide in (GuideState.EMPTY, GuideState.WIRE):
        return (Trigger.TARGET_DONE,)
    return (Trigger.SLEEVE_REMOVED,)


def route(case: CaseState, goals: frozenset[State]) -> tuple[Trigger, ...]:
    """First steps on the shortest ways from a case to any of these states."""
    distances = _distances(goals)
    steps = [(distances[to], row.trigger) for row, to in _steps(case) if to in distances]
    nearest = min((distance for distance, _ in steps), default=None)
    first = dict.fromkeys(_asked_for(case, trigger) for distance, trigger in steps if distance == nearest)
    return tuple(first) or (Trigger.HOLD_REQUESTED,)


def towards(case: CaseState, wanted: Trigger) -> tuple[Trigger, ...]:
    """The wanted trigger itself where this state lists it, else the first steps to a state that does."""
    if listed(case.state, wanted):
        return (wanted,)
    return route(case, _listing(wanted))


@cache
def _listing(wanted: Trigger) -> frozenset[State]:
    return frozenset(state for state in State if listed(state, wanted))


@cache
def _ways() -> tuple[Row, ...]:
    rows = (entry for entry in TABLE if isinstance(entry, Row))
    return tuple(row for row in rows if row.trigger not in _NO_WAY_ON and row.to not in (Goto.SAME, State.SAFE_HOLD))


@lru_cache(maxsize=16)  # a status asks it of one case for every request that is refused
def _steps(case: CaseState) -> tuple[tuple[Row, State], ...]:
    """Rows that lead out of the state of this very case, each with where it would settle."""
    rows = (row for row in _ways() if case.state in row.sources)
    return tuple((row, row.to if isinstance(row.to, State) else _settled(case, row)) for row in rows)


def _settled(case: CaseState, row: Row) -> State:
    """Rows that settle only void and close: what they do needs nothing that comes with the trigger."""
    inquiry = Inquiry(case, row.trigger, None, unknown_snapshot(), Limits(), 0.0)
    return settle(reduce(lambda after, change: change(after, inquiry), row.changes, case))


@cache
def _distances(goals: frozenset[State]) -> dict[State, int]:
    """Steps from every state to the nearest goal, wherever rows can settle."""
    distances = dict.fromkeys(goals, 0)
    queue = deque(goals)
    while queue:
        reached = queue.popleft()
        for row in _ways():
            if reached in (row.settles_to or {row.to}):
                for source in row.sources - distances.keys():
                    distances[source] = distances[reached] + 1
                    queue.append(source)
    return distances


def _asked_for(case: CaseState, trigger: Trigger) -> Trigger:
    """What a person does so that an observation can follow."""
    if trigger in (Trigger.IMAGE_ARRIVED, Trigger.VERIFICATION_PASSED, Trigger.VERIFICATION_FAILED):
        return Trigger.EXPOSURE_REQUESTED
    if trigger is Trigger.MOVE_STARTED:
        missing = first_missing(case, trigger, None)
        return MAKERS[missing] if missing else trigger
    return trigger

"""Where a case comes to rest: the state that its insertion and its chain amount to."""

from workflow.case import CaseState
from workflow.links import Link
from workflow.states import InsertionStatus, State

AIM = (Link.VIEW, Link.IMAGE, Link.REGISTRATION, Link.TARGET)
_NEWEST_FIRST = (
    (Link.TARGET, State.TARGET_CHOSEN),
    (Link.REGISTRATION, State.REGISTERED),
    (Link.IMAGE, State.IMAGE_ACQUIRED),
    (Link.VIEW, State.CARM_POSITIONED),
)


def settle(case: CaseState) -> State:
    """The calm state of a case, from what is valid in it."""
    if case.insertion is not None:
        return State.SLEEVE_INSERTED if case.insertion.status is InsertionStatus.DONE else State.INSERTING
    if case.verification is not None and case.verification.passed:
        return State.VERIFIED
    if case.motion is not None and all(case.link(link) for link in AIM):
        return State.OFF_TARGET if case.verification is not None else State.MOVED
    return next((state for link, state in _NEWEST_FIRST if case.link(link)), State.CASE_OPEN)

"""States of a case, of the guide's bore and of an insertion."""

from enum import StrEnum


class State(StrEnum):
    """Where a case stands."""

    CASE_OPEN = "case_open"
    CARM_POSITIONED = "carm_positioned"
    IMAGE_ACQUIRED = "image_acquired"
    REGISTERED = "registered"
    TARGET_CHOSEN = "target_chosen"
    MOVING = "moving"
    MOVED = "moved"
    VERIFIED = "verified"
    OFF_TARGET = "off_target"
    INSERTING = "inserting"
    SLEEVE_INSERTED = "sleeve_inserted"
    SAFE_HOLD = "safe_hold"
    CLOSED = "closed"
    ABORTED = "aborted"


OVER = frozenset({State.CLOSED, State.ABORTED})
LIVE = frozenset(State) - OVER
INSERTION = frozenset({State.INSERTING, State.SLEEVE_INSERTED})
IDLE = LIVE - INSERTION - {State.MOVING, State.SAFE_HOLD}


class GuideState(StrEnum):
    """What a person said is in the guide's bore (H35); unknown counts as an instrument."""

    EMPTY = "empty"
    WIRE = "wire"
    INSTRUMENT = "instrument"
    UNKNOWN = "unknown"


class InsertionStatus(StrEnum):
    """How far the sleeve of the current attempt is."""

    OPEN = "open"
    DONE = "done"

"""What a row of the transition table is made of."""

from dataclasses import dataclass
from enum import StrEnum

from workflow.changes import Change
from workflow.decisions import Effect
from workflow.states import State
from workflow.triggers import Trigger


class Goto(StrEnum):
    """Targets of a row that depend on the case."""

    SAME = "same"
    SETTLE = "settle()"


class Branch(StrEnum):
    """What a trigger turns out to be, where one trigger has several rows in a state."""

    ALWAYS = "always"
    ACCEPTED = "in the window and accepted"
    OTHERWISE = "otherwise"
    SOUND = "every check passed"
    UNSOUND = "a check failed"
    CURRENT = "subject current"
    LATE = "subject not current"
    AT_GOAL = "onto a target, at the goal"
    ELSEWHERE = "of another kind, or elsewhere"
    AT_REST = "at rest"
    ADRIFT = "not at rest"
    PASSED = "checks hold, within the limits"
    EXCEEDED = "checks hold, limits exceeded"
    UNUSABLE = "a check failed or could not be made: unusable"
    VIEW_MOVED = "the rings' motion is not the arm's"
    PATIENT_SHIFTED = "the anatomy shifted"
    INSERTION_OPEN = "S open"
    INSERTION_NOT_OPEN = "S not open"
    EMPTY = "S neither open nor done, guide empty"
    NOT_EMPTY = "S neither open nor done, guide not empty"
    INSERTED = "S open or done"


@dataclass(frozen=True, slots=True)
class Row:
    """From these states, on this trigger and branch, to there, with these changes and effects."""

    number: int
    trigger: Trigger
    sources: frozenset[State]
    branches: frozenset[Branch]
    to: State | Goto
    changes: tuple[Change, ...]
    effects: tuple[Effect, ...]
    settles_to: frozenset[State]  # where `settle()` can end, for the picture and the machine; else empty
    taken_as: Trigger | None  # the trigger that the checks make of it, where it is another


@dataclass(frozen=True, slots=True)
class Unlisted:
    """Cells without a row: requests are refused with what leads onwards, observations late, facts recorded."""

    trigger: Trigger
    states: frozenset[State]
    branches: frozenset[Branch]

"""The table on `transitions`: the only code that may say which state follows which."""

from dataclasses import dataclass
from typing import Any

from transitions import Machine, MachineError

from workflow.rows import Goto, Row
from workflow.states import State
from workflow.table import TABLE


class IllegalTransitionError(Exception):
    """The machine does not know this change of state: the rules contradict one another, and nothing was changed."""


@dataclass(slots=True)
class _Walker:
    """The machine's private model: nothing but a state."""

    state: State


def _chosen(row: Row, to: State) -> Any:
    """A condition without effects: this row was chosen, and it ends there."""
    return lambda event: event.kwargs["row"] is row and event.kwargs["to"] is to


def _targets(row: Row, source: State) -> frozenset[State]:
    match row.to:
        case Goto.SAME:
            return frozenset({source})
        case Goto.SETTLE:
            return row.settles_to
        case _:
            return frozenset({row.to})


def _build() -> Machine:
    # No automatic `to_X` triggers (they skip every condition), no model of its own, no callbacks: nothing does I/O.
    machine = Machine(model=None, states=State, initial=State.CASE_OPEN, auto_transitions=False, send_event=True)
    for row in (entry for entry in TABLE if isinstance(entry, Row)):
        for source in row.sources:
            for to in _targets(row, source):
                machine.add_transition(row.trigger.value, source, to, conditions=_chosen(row, to))
    return machine


_MACHINE = _build()


def fire(state: State, row: Row, to: State) -> State:
    """Walk one row from a state to where the case settles.

    Raises
    ------
    IllegalTransitionError
        If the row does not lead there: a false condition, which `transitions` only reports, is an error here.
    """
    walker = _Walker(state)
    try:
        walked = _MACHINE.events[row.trigger.value].trigger(walker, row=row, to=to)
    except MachineError as error:
        raise IllegalTransitionError(f"{row.trigger} is not listed in {state}") from error
    if not walked:
        raise IllegalTransitionError(f"row {row.number} on {row.trigger} does not lead from {state} to {to}")
    return walker.state

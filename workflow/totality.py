"""The table, indexed by cell and checked: exactly one entry for every state, trigger and branch."""

from collections.abc import Iterable
from functools import cache

from workflow.branches import branches_of
from workflow.rows import Branch, Goto, Row, Unlisted
from workflow.states import State
from workflow.table import TABLE
from workflow.triggers import Trigger

Cell = tuple[State, Trigger, Branch]


class IncompleteTableError(Exception):
    """The transition table leaves a cell open, or fills one twice; nothing may run on it."""


def index(entries: Iterable[Row | Unlisted]) -> dict[Cell, Row | Unlisted]:
    """The entry of every cell.

    Raises
    ------
    IncompleteTableError
        If a cell has no entry, two entries, or one on a branch that cannot happen; or if a settling row does not say
        where it can end.
    """
    cells: dict[Cell, Row | Unlisted] = {}
    for entry in entries:
        _check_target(entry)
        for cell in _cells(entry):
            if cell in cells:
                raise IncompleteTableError(f"two entries for {_named(cell)}")
            cells[cell] = entry
    _check_total(cells)
    return cells


def _cells(entry: Row | Unlisted) -> Iterable[Cell]:
    states = entry.sources if isinstance(entry, Row) else entry.states
    return ((state, entry.trigger, branch) for state in states for branch in entry.branches)


def _check_target(entry: Row | Unlisted) -> None:
    if isinstance(entry, Row) and (entry.to is Goto.SETTLE) != bool(entry.settles_to):
        raise IncompleteTableError(f"row {entry.number} on {entry.trigger} does not say where it settles")


def _check_total(cells: dict[Cell, Row | Unlisted]) -> None:
    expected = {(state, trigger, branch) for state in State for trigger in Trigger for branch in branches_of(trigger)}
    for problem, found in (("no entry for", expected - set(cells)), ("impossible", set(cells) - expected)):
        if found:
            raise IncompleteTableError(f"{problem} {_named(min(found))}; {len(found)} cells in all")


def _named(cell: Cell) -> str:
    state, trigger, branch = cell
    return f"{trigger} in {state} ({branch})"


CELLS = index(TABLE)


@cache
def listed(state: State, trigger: Trigger) -> bool:
    """Whether any row has this trigger in this state."""
    return any(isinstance(CELLS[state, trigger, branch], Row) for branch in branches_of(trigger))

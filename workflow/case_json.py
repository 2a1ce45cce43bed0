"""A case as JSON and back, so that the service can rebuild it from its last event."""

from typing import Any

from workflow.case import CaseState


def to_json(case: CaseState) -> dict[str, Any]:
    """The case as a dict of strings, numbers, lists and dicts."""
    raise NotImplementedError(case)


def from_json(data: dict[str, Any]) -> CaseState:
    """The case that `to_json` wrote.

    Raises
    ------
    ValueError
        If a field is missing, unknown or of another type.
    """
    raise NotImplementedError(data)

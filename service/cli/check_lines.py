"""Items of a check as lines of text: what was measured, the limit, and what to do where it fails."""

from collections.abc import Iterable, Mapping
from typing import Any

import typer

Item = Mapping[str, Any]


def tell(items: Iterable[Item]) -> None:
    """A line for each item."""
    for one in items:
        measured = f"{one['measured']:.3g}" if isinstance(one["measured"], float) else one["measured"]
        limit = "" if one["limit"] is None else f" ({_asked(one['limit'])})"
        line = f"{'ok  ' if one['passed'] else 'FAIL'}  {one['code']}: {measured}{limit} {one['unit']}"
        typer.echo(line.rstrip() + (f". {one['what_to_do']}" if one["what_to_do"] else ""))


def _asked(limit: object) -> str:
    """A limit is a number; of anything else it is said what it is to be."""
    is_number = isinstance(limit, int | float) and not isinstance(limit, bool)
    told = f"{limit:.3g}" if isinstance(limit, float) else limit  # radians have sixteen digits
    return f"limit {told}" if is_number else f"asked: {told}"

"""Compares what was recorded with what was computed anew, number by number."""

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from service.database.json_text import portable
from service.replay.inputs import Difference

# Of the requirement: a record is equal to 1e-9, of a number's own size.
_RELATIVE = 1e-9
# px, mm, deg and their squares: what rounding leaves of zero on another processor.
_ABSOLUTE = 1e-12
# How long the work took is no result of it.
_NO_RESULT = frozenset({"elapsed_ms"})


def differences(where: str, recorded: Any, recomputed: Any) -> list[Difference]:
    """Every field in which the two differ."""
    walk = _walk("", recorded, portable(recomputed))  # as the record can say it
    return [Difference(where, field, one, other) for field, one, other in walk]


def _walk(field: str, recorded: Any, recomputed: Any) -> Iterator[tuple[str, Any, Any]]:
    match recorded, recomputed:
        case Mapping(), Mapping():
            for key in sorted((recorded.keys() | recomputed.keys()) - _NO_RESULT):
                yield from _walk(f"{field}.{key}" if field else key, recorded.get(key), recomputed.get(key))
        case list(), list() if len(recorded) == len(recomputed):
            yield from _walk_items(field, recorded, recomputed)
        case _ if not _is_equal(recorded, recomputed):
            yield field, recorded, recomputed


def _walk_items(field: str, recorded: Sequence[Any], recomputed: Sequence[Any]) -> Iterator[tuple[str, Any, Any]]:
    for index, (one, other) in enumerate(zip(recorded, recomputed, strict=True)):
        yield from _walk(f"{field}[{index}]", one, other)


def _is_equal(recorded: Any, recomputed: Any) -> bool:
    if _is_number(recorded) and _is_number(recomputed):
        return math.isclose(recorded, recomputed, rel_tol=_RELATIVE, abs_tol=_ABSOLUTE)
    return type(recorded) is type(recomputed) and bool(recorded == recomputed)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool)

"""JSON as the database stores it: keys in order, and no NaN, which is not JSON and which PostgreSQL refuses."""

import json
import math
from collections.abc import Mapping
from typing import Any

# RFC 7493: readers that hold numbers as doubles know larger integers only roughly.
_LARGEST_INTEGER = 2**53 - 1


def to_text(value: Any) -> str:
    """JSON text of one form, of what every reader can hold."""
    return json.dumps(portable(value), sort_keys=True, separators=(",", ":"), allow_nan=False)


def portable(value: Any) -> Any:
    """A value as JSON can say it: numbers that it cannot hold (not finite, beyond 2^53) become text, none is lost."""
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, int) and abs(value) > _LARGEST_INTEGER:
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): portable(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [portable(one) for one in value]
    return value

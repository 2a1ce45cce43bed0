"""JSON as the database stores it: keys in order, and no NaN, which is not JSON and which PostgreSQL refuses."""

import json
import math
from collections.abc import Mapping
from typing import Any


def to_text(value: Any) -> str:
    """Canonical JSON text; a float that is not finite becomes the text nan, inf or -inf, so that no fact is lost."""
    return json.dumps(_finite(value), sort_keys=True, separators=(",", ":"), allow_nan=False)


def _finite(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): _finite(one) for key, one in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(one) for one in value]
    return value

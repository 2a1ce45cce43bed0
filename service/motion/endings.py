"""Tells whoever holds the button how the motion ended, once that is in the record."""

import asyncio
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, slots=True)
class Ending:
    """The end of a motion, as it was recorded."""

    cause: str
    state: str
    version: int
    distance_mm: float | None
    angle_deg: float | None
    problem: dict[str, Any] | None


class Endings:
    """Endings awaited, by permit; used on the event loop only."""

    def __init__(self) -> None:
        self._awaited: dict[str, asyncio.Future[Ending]] = {}

    def expect(self, permit_id: str) -> "asyncio.Future[Ending]":
        """The ending of a permit's motion, to be awaited."""
        return self._awaited.setdefault(permit_id, asyncio.get_running_loop().create_future())

    def forget(self, permit_id: str) -> None:
        """Nobody awaits it any more."""
        self._awaited.pop(permit_id, None)

    def tell(self, permit_id: str, ending: Ending) -> None:
        """The motion is over."""
        awaited = self._awaited.get(permit_id)
        if awaited is not None and not awaited.done():
            awaited.set_result(ending)

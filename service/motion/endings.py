"""Tells whoever holds the button how the motion ended, once that is in the record."""

import asyncio
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
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
        self._awaited: dict[str, list[asyncio.Future[Ending]]] = {}

    @contextmanager
    def expected(self, permit_id: str) -> Iterator["asyncio.Future[Ending]"]:
        """The ending of a permit's motion, to be awaited; one for each who asks, so that nobody takes another's."""
        ending: asyncio.Future[Ending] = asyncio.get_running_loop().create_future()
        self._awaited.setdefault(permit_id, []).append(ending)
        try:
            yield ending
        finally:
            self._awaited[permit_id].remove(ending)
            if not self._awaited[permit_id]:
                del self._awaited[permit_id]

    def tell(self, permit_id: str, ending: Ending) -> None:
        """The motion is over."""
        _set(self._awaited.get(permit_id, ()), ending)

    def tell_all(self, ending: Ending) -> None:
        """Whatever moved is over, and nobody will tell how that motion ended."""
        for awaited in self._awaited.values():
            _set(awaited, ending)


def _set(awaited: "Iterable[asyncio.Future[Ending]]", ending: Ending) -> None:
    for one in awaited:
        if not one.done():
            one.set_result(ending)

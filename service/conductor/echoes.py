"""Picked points that were drawn back and wait for the surgeon's confirmation (H08); in memory, a restart voids them."""

import threading
from collections import OrderedDict
from dataclasses import dataclass

_REMEMBERED = 256


@dataclass(frozen=True, slots=True)
class Echo:
    """A point as the server understood it."""

    id: str
    case_id: str
    image_id: str
    registration_id: str
    raw_px: tuple[float, float]
    corrected_px: tuple[float, float]


class Echoes:
    """The newest echoes, by id."""

    def __init__(self) -> None:
        self._echoes: OrderedDict[str, Echo] = OrderedDict()
        self._lock = threading.Lock()

    def remember(self, echo: Echo) -> None:
        """Keep an echo; the oldest gives way."""
        with self._lock:
            self._echoes[echo.id] = echo
            while len(self._echoes) > _REMEMBERED:
                self._echoes.popitem(last=False)

    def find(self, case_id: str, echo_id: str) -> Echo | None:
        """An echo of this case; None if it was never drawn or is too old."""
        with self._lock:
            echo = self._echoes.get(echo_id)
        return echo if echo is not None and echo.case_id == case_id else None

"""Daily checks that wait for their image; in memory, a restart voids them."""

import threading
from collections import OrderedDict
from dataclasses import dataclass

from service.conductor.check_items import CheckItem

_REMEMBERED = 8  # as many exposures as the arm's watch keeps


@dataclass(frozen=True, slots=True)
class BegunCheck:
    """What was measured before the image, and how many images there were then."""

    id: str
    user_id: str
    images_before: int
    items: tuple[CheckItem, ...]


class BegunChecks:
    """The newest, by id; each is finished once."""

    def __init__(self) -> None:
        self._begun: OrderedDict[str, BegunCheck] = OrderedDict()
        self._lock = threading.Lock()

    def remember(self, check: BegunCheck) -> None:
        """Keep one; the oldest gives way."""
        with self._lock:
            self._begun[check.id] = check
            while len(self._begun) > _REMEMBERED:
                self._begun.popitem(last=False)

    def take(self, check_id: str) -> BegunCheck | None:
        """The check, which is then no longer waiting; None if there is none."""
        with self._lock:
            return self._begun.pop(check_id, None)

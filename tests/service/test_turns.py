"""Whose turn it is to write: one at a time, images behind everything else, and nobody waits for ever."""

import threading
import time

import pytest

from service.database.turns import Turns
from service.errors import ErrorCode, ServiceError


def _queued(turns: Turns, order: list[str], name: str, *, bulky: bool) -> threading.Thread:
    """A writer that waits behind whoever writes now."""

    def write() -> None:
        with turns.taken(bulky=bulky):
            order.append(name)

    thread = threading.Thread(target=write)
    thread.start()
    time.sleep(0.05)
    return thread


def test_images_go_behind_whoever_came_later_and_is_none():
    turns, order = Turns(30.0), []
    with turns.taken(bulky=True):
        waiting = [_queued(turns, order, f"image {n}", bulky=True) for n in range(3)]
        waiting += [_queued(turns, order, f"permit {n}", bulky=False) for n in range(3)]
        assert order == []
    for thread in waiting:
        thread.join(30.0)
    assert sorted(order[:3]) == ["permit 0", "permit 1", "permit 2"]
    assert sorted(order[3:]) == ["image 0", "image 1", "image 2"]


def test_a_writer_that_fails_leaves_its_turn_to_the_next():
    turns = Turns(1.0)
    with pytest.raises(RuntimeError), turns.taken(bulky=False):
        raise RuntimeError
    with turns.taken(bulky=True):
        pass


@pytest.mark.parametrize("bulky", [True, False])
def test_a_turn_that_does_not_come_in_time_is_refused_and_holds_nobody_up(bulky):
    turns = Turns(0.1)
    with turns.taken(bulky=False):
        refused = []

        def write() -> None:
            try:
                with turns.taken(bulky=bulky):
                    pass
            except ServiceError as error:
                refused.append((error.code, error.limit))

        thread = threading.Thread(target=write)
        thread.start()
        thread.join(30.0)
        assert refused == [(ErrorCode.DATABASE_BUSY, 0.1)]
    with turns.taken(bulky=True):
        pass

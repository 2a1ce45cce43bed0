"""What the arm's library leaves open is closed, and nothing else."""

import os
import select
import socket

import pytest

from robot.library_waits import Waits


def test_what_a_block_left_to_wait_on_is_closed_and_nothing_else_is():
    waits, before = Waits(), select.epoll()
    with waits.noted():
        left, connection = os.eventfd(0), socket.socket()
    with before, connection:
        waits.close()
        with pytest.raises(OSError, match="Bad file descriptor"):
            os.fstat(left)
        assert not before.closed
        assert os.fstat(before.fileno())
        assert os.fstat(connection.fileno())
        waits.close()  # nothing is left of it


def test_of_an_interface_that_was_not_made_nothing_is_noted():
    waits = Waits()
    with pytest.raises(RuntimeError), waits.noted():
        raise RuntimeError("the constructor failed")
    waits.close()

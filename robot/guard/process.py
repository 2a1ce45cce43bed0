"""The guard's process: commands from stdin, events to stdout, one loop between them."""

import os
import signal
import sys
import time
from enum import Enum
from pathlib import Path
from queue import Empty, SimpleQueue
from threading import Thread
from typing import BinaryIO, TypeAlias

from robot.arm import Arm
from robot.errors import MessageError
from robot.guard.guard import Guard, Taken
from robot.guard.journal import Journal
from robot.guard.lines import decode_command
from robot.guard.messages import Phase, ReleasePendant, Stop
from robot.guard.outbox import Outbox
from robot.guard.parent import end_with_parent
from robot.guard.pauses import spare_what_is_loaded, take_short_turns
from robot.guard.precedence import take_precedence
from robot.ur5 import UR5

_TURN_S = 0.003  # longest pause between two looks at the arm, whose cycle is 8 ms (CB3) or 2 ms
_MOST_A_TURN = 20  # commands; a hand sends one in eight turns
_AT_REST = (Phase.IDLE, Phase.HELD)


class _Parent(Enum):
    GONE = "gone"


_Inbox: TypeAlias = SimpleQueue[Taken | _Parent]


def run(arm_address: str, journal_folder: Path) -> None:
    """Guard one arm until the parent is gone or the arm's library stuck, and the arm at rest; or the link broken."""
    outbox = Outbox(_take_stdout())
    take_short_turns()
    take_precedence(passed_on=True)  # the arm's library reads in threads of its own
    journal = Journal(journal_folder)
    arm = UR5(arm_address)
    guard = Guard(arm, journal, outbox.put)
    inbox: _Inbox = SimpleQueue()
    asked = _heed_signals()
    end_with_parent()
    Thread(target=_await_end, args=(asked, guard, inbox), name="end", daemon=True).start()
    Thread(target=_receive, args=(sys.stdin.buffer, guard, inbox), name="commands", daemon=True).start()
    spare_what_is_loaded()
    _turn_until_over(guard, inbox, outbox, arm)
    journal.close()
    arm.close()
    os._exit(0)  # the library's destructors would take seconds, and end nothing that is not ended


def _take_stdout() -> int:
    """Keep the pipe to the parent for events alone: what the arm's library prints goes to stderr."""
    events = os.dup(1)
    os.dup2(2, 1)
    return events


def _heed_signals() -> int:
    """A pipe that has something to read once this process is asked to end; a terminal's interrupt is ignored.

    No signal may interrupt the loop: in Python 3.11 the rest of a queue's time limit can then be negative, for ever.
    """
    asked, ask = os.pipe()
    os.set_blocking(ask, False)
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, lambda *_: None)
    signal.set_wakeup_fd(ask, warn_on_full_buffer=False)
    signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGTERM})
    return asked


def _await_end(asked: int, guard: Guard, inbox: _Inbox) -> None:
    """Being asked to end is like losing the parent, and how the system tells that it is lost, thread by thread."""
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGTERM})
    os.read(asked, 1)
    guard.stop_now("asked to end")
    inbox.put(_Parent.GONE)


def _receive(lines: BinaryIO, guard: Guard, inbox: _Inbox) -> None:
    """Take commands from the pipe; a stop goes out from here, before the loop knows of it."""
    for line in lines:
        try:
            command = decode_command(line)
        except MessageError as error:
            command = Stop(str(error))  # what nobody understands may have been a stop
        if isinstance(command, Stop | ReleasePendant):
            inbox.put(guard.stop_now(command.reason))
        if not isinstance(command, Stop):
            inbox.put(command)
    guard.stop_now("the service is gone")
    inbox.put(_Parent.GONE)


def _turn_until_over(guard: Guard, inbox: _Inbox, outbox: Outbox, arm: Arm) -> None:
    parent = os.getppid()
    orphaned = False
    while not (guard.phase in _AT_REST and (orphaned or guard.severed or arm.is_stuck())):
        gone = _handle(guard, inbox) or outbox.broken or os.getppid() != parent
        if gone and not orphaned:  # a forked process may still hold the pipe: hence the look at the parent itself
            orphaned = True
            guard.lose_parent()
        guard.tick()
        outbox.push()


def _handle(guard: Guard, inbox: _Inbox) -> bool:
    """Handle what has arrived, after waiting a turn for it; True if the parent is gone.

    However much arrives, the arm is looked at in between: a stop has gone out from another thread.
    """
    gone = False
    deadline_s = time.monotonic() + _TURN_S
    for _ in range(_MOST_A_TURN):
        try:
            taken = inbox.get(timeout=max(deadline_s - time.monotonic(), 0.0))
        except Empty:
            return gone
        deadline_s = 0.0
        if isinstance(taken, _Parent):
            gone = True
        else:
            guard.handle(taken)
    return gone

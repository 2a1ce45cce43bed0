"""The programs a controller can run: the control program of the ur-rtde client, and any other."""

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Protocol

from simulator.controller.async_status import AsyncStatus
from simulator.controller.commands import COMMANDS, REALTIME
from simulator.controller.questions import ProgramError
from simulator.controller.script import CONTROL_PROGRAM, PathMove, Upload

if TYPE_CHECKING:
    from simulator.controller.core import ControllerCore

READY, DONE = 1, 2
STOP_SCRIPT = 255

# Statements of a program that take time: each item is one controller cycle.
Steps = Iterator[None]


class Program(Protocol):
    """Something that runs, one step a controller cycle."""

    name: str

    def cycle(self) -> bool:
        """Run one step; False at the end of the program.

        Raises
        ------
        ProgramError
            If the program fails as a script would.
        """


class ControlProgram:
    """Takes commands from the input registers: realtime ones each cycle, others once until they are withdrawn."""

    name = CONTROL_PROGRAM

    def __init__(self, core: "ControllerCore", upload: Upload) -> None:
        self.core = core
        self.offset = upload.register_offset
        self.path: tuple[PathMove, ...] = upload.path
        self.stops_along_line = False  # synchronous stops run stopj until an asynchronous one was made
        self._status = AsyncStatus()
        self._latched = False
        self._blocking: Steps | None = None
        self._thread: Steps | None = None
        self._write_status()
        self._answer(READY)

    def cycle(self) -> bool:
        """One pass of the main loop, and one of the asynchronous operation."""
        self._advance_thread()
        if self._blocking is not None:
            if next(self._blocking, self) is self:
                self._blocking = None
                self._answer(DONE)
            return True
        command = self.core.registers.input_integers[self.offset]
        if command == STOP_SCRIPT:
            return False
        if command in REALTIME:
            self._run(command)
            self._answer(READY)
        elif command == 0:
            self._latched = False
            self._answer(READY)
        elif not self._latched:
            self._latched = True
            self._run(command)
            if self._blocking is None:
                self._answer(DONE)
        return True

    def doubles(self, start: int, count: int) -> tuple[float, ...]:
        """Arguments from the input registers."""
        first = self.offset + start
        return tuple(self.core.registers.input_doubles[first : first + count])

    def integer(self, index: int) -> int:
        """An argument from the input registers."""
        return self.core.registers.input_integers[self.offset + index]

    def result(self, values: tuple[float, ...]) -> None:
        """Give a vector back."""
        first = self.offset
        self.core.registers.output_doubles[first : first + len(values)] = values

    def verdict(self, value: int) -> None:
        """Give a scalar back."""
        self.core.registers.output_integers[self.offset + 1] = value

    def signal(self, change: Callable[[AsyncStatus], None]) -> None:
        """Change the status word."""
        change(self._status)
        self._write_status()

    def block(self, steps: Steps) -> None:
        """Do nothing else until the steps are through."""
        self._blocking = steps

    def run_thread(self, steps: Steps) -> None:
        """Go through the steps beside the main loop, from the next cycle on."""
        self._thread = self._signalled(steps)

    def end_thread(self) -> None:
        """Kill the asynchronous operation and say that it is over."""
        if self._thread is not None:
            self._thread = None
            self.signal(AsyncStatus.finish)

    def _signalled(self, steps: Steps) -> Steps:
        self.signal(AsyncStatus.start)
        yield from steps
        self.signal(AsyncStatus.finish)

    def _advance_thread(self) -> None:
        if self._thread is not None and next(self._thread, self) is self:
            self._thread = None

    def _run(self, command: int) -> None:
        handler = COMMANDS.get(command)
        if handler is None:
            raise ProgramError(f"command {command} is not simulated")
        handler(self)

    def _answer(self, value: int) -> None:
        self.core.registers.output_integers[self.offset] = value

    def _write_status(self) -> None:
        self.core.registers.output_integers[self.offset + 2] = self._status.word


class OtherProgram:
    """A program that is not interpreted: it says ready, takes a moment, and says done."""

    _CYCLES = 12

    def __init__(self, core: "ControllerCore", upload: Upload) -> None:
        self.name = upload.name
        self._core = core
        self._left = self._CYCLES
        self._answer(READY)

    def cycle(self) -> bool:
        """Wait for the end."""
        self._left -= 1
        if self._left == 0:
            self._answer(DONE)
        return self._left > 0

    def _answer(self, value: int) -> None:
        self._core.registers.output_integers[0] = value

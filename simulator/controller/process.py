"""A simulated controller in a process of its own, spoken to by JSON lines over its pipes."""

import json
import select
import subprocess
import sys
import threading
from types import TracebackType
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from simulator.controller.codec import from_json, to_json
from simulator.controller.settings import ControllerSettings, Payload
from simulator.controller.state import ArmSample, ControllerState, WireRecord
from simulator.controller.states import Fault, PowerAction

Array = NDArray[np.float64]

_START_TIMEOUT_S = 60.0  # imports on a busy machine
_ANSWER_TIMEOUT_S = 15.0
_END_TIMEOUT_S = 10.0


class ControllerProcess:
    """Offers what `Controller` does, from outside; the process ends with its input pipe, so never outlives its owner.

    Raises
    ------
    OSError
        If the address or a port of it is taken.
    """

    def __init__(self, settings: ControllerSettings) -> None:
        self.settings = settings
        self._lock = threading.Lock()
        command = [sys.executable, "-m", "simulator.controller"]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)  # noqa: S603  # own module
        try:
            self._exchange({"settings": to_json(settings)}, _START_TIMEOUT_S)
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> Self:
        """The controller itself."""
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close it."""
        self.close()

    @property
    def address(self) -> str:
        """The loopback address of the three servers."""
        return self.settings.address

    @property
    def pid(self) -> int:
        """Of the process."""
        return self._process.pid

    def state(self) -> ControllerState:
        """The present moment."""
        state: ControllerState = self._ask("state")
        return state

    def inject(self, fault: Fault) -> None:
        """Plant a fault; it stays until cleared."""
        self._ask("inject", fault)

    def clear(self, fault: Fault | None = None) -> None:
        """Take one fault away, or all; stops stay latched until they are released as on a real arm."""
        self._ask("clear", fault)

    def release(self) -> None:
        """Clear all faults and bring the arm to running and normal, as a person at the pendant would, at once."""
        self._ask("release")

    def power(self, action: PowerAction) -> None:
        """Switch the arm's power from the pendant."""
        self._ask("power", action)

    def jog(self, joints_delta_rad: Array, speed_rad_s: float = 0.2) -> None:
        """Move the joints (6,) by this much from the pendant; raises ValueError as `Controller.jog` does."""
        self._ask("jog", joints_delta_rad, speed_rad_s)

    def jog_linear(self, step_in_base_mm: Array, speed_mm_s: float = 20.0) -> None:
        """Move the TCP from the pendant; raises ValueError as `Controller.jog_linear` does."""
        self._ask("jog_linear", step_in_base_mm, speed_mm_s)

    def push(self, step_in_base_mm: Array) -> None:
        """Disturb the arm at rest; raises ValueError as `Controller.push` does."""
        self._ask("push", step_in_base_mm)

    def teleport(self, joints_rad: Array) -> None:
        """Put the arm elsewhere between two cycles, to set a scene up."""
        self._ask("teleport", joints_rad)

    def set_tcp(self, flange_from_tcp: Array) -> None:
        """Change the controller's TCP setting (4x4, mm), as somebody at the pendant could."""
        self._ask("set_tcp", flange_from_tcp)

    def set_payload(self, payload: Payload) -> None:
        """Change the controller's payload setting."""
        self._ask("set_payload", payload)

    def set_speed_scaling(self, fraction: float) -> None:
        """Move the pendant's speed slider, 0 to 1."""
        self._ask("set_speed_scaling", fraction)

    def wire(self, after: int = -1) -> tuple[WireRecord, ...]:
        """What reached the controller, oldest first, numbers above `after`."""
        records: tuple[WireRecord, ...] = self._ask("wire", after)
        return records

    def samples(self, since_s: float = 0.0) -> tuple[ArmSample, ...]:
        """The arm's recorded cycles from a monotonic time on."""
        samples: tuple[ArmSample, ...] = self._ask("samples", since_s)
        return samples

    def close(self) -> None:
        """End the process; a second call does nothing."""
        for pipe in (self._process.stdin, self._process.stdout):
            if pipe is not None:
                pipe.close()
        try:
            self._process.wait(_END_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _ask(self, call: str, *arguments: object) -> Any:
        return self._exchange({"call": call, "arguments": to_json(arguments)}, _ANSWER_TIMEOUT_S)

    def _exchange(self, request: dict[str, Any], timeout_s: float) -> Any:
        """One line there, one line back.

        Raises
        ------
        TimeoutError
            If the process does not answer in time; it is ended then.
        ConnectionError
            If it is gone.
        ValueError, OSError
            As the controller itself raised it.
        """
        stdin, stdout = self._process.stdin, self._process.stdout
        if stdin is None or stdout is None:
            raise ConnectionError("the controller's process has no pipes")
        with self._lock:
            stdin.write(json.dumps(request).encode() + b"\n")
            stdin.flush()
            if not select.select([stdout], [], [], timeout_s)[0]:
                self._process.kill()  # a late answer would be taken for that of the next call
                raise TimeoutError("the controller's process does not answer")
            line = stdout.readline()
        if not line:
            raise ConnectionError("the controller's process has ended")
        answer = json.loads(line)
        if "error" in answer:
            raise {"ValueError": ValueError, "OSError": OSError}.get(answer["kind"], RuntimeError)(answer["error"])
        return from_json(answer["result"])

"""What reached the controller and what the arm did, kept for the tests; bounded."""

import time
from collections import deque
from collections.abc import Mapping
from itertools import count

from simulator.controller.addresses import RTDE_PORT
from simulator.controller.framing import Value
from simulator.controller.state import ArmSample, WireRecord

RECORDS = 20_000
SAMPLES = 15_000  # two minutes at 125 Hz
_COMMAND_REGISTERS = ("input_int_register_0", "input_int_register_24")


class WireLog:
    """The newest records and samples."""

    def __init__(self) -> None:
        self._numbers = count()
        self._records: deque[WireRecord] = deque(maxlen=RECORDS)
        self._samples: deque[ArmSample] = deque(maxlen=SAMPLES)

    def add(self, port: int, kind: str, text: str = "", command: int = -1) -> None:
        """Note something that arrived now."""
        self._records.append(WireRecord(next(self._numbers), time.monotonic(), port, kind, text, command))

    def add_input(self, values: Mapping[str, Value]) -> None:
        """Note an input packet with its command and arguments."""
        commands = [value for name, value in values.items() if name in _COMMAND_REGISTERS]
        arguments = [_written(value) for name, value in values.items() if name not in _COMMAND_REGISTERS]
        self.add(RTDE_PORT, "input", " ".join(arguments), int(_written(commands[0])) if commands else -1)

    def add_sample(self, sample: ArmSample) -> None:
        """Note one cycle of the arm."""
        self._samples.append(sample)

    def records(self, after: int) -> tuple[WireRecord, ...]:
        """Records with a higher number, oldest first."""
        return tuple(record for record in self._records if record.number > after)

    def samples(self, since_s: float) -> tuple[ArmSample, ...]:
        """Samples from a monotonic time on, oldest first."""
        return tuple(sample for sample in self._samples if sample.at_s >= since_s)


def _written(value: Value) -> str:
    return " ".join(map(_written, value)) if isinstance(value, tuple) else f"{value:.6g}"

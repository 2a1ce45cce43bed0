"""The controller's own log as the witness of a stop."""

import time

from simulator.controller import ControllerProcess, WireRecord

_STOP_SCRIPT = 255  # the command register that ends the control script
_MOVE_LINEAR = 3
_QUIET_S = 0.3  # the guard sends a stop that shows no effect again after 0.2 s
_WITHIN_S = 5.0
_LOOK_S = 0.01


class Wire:
    """What reached a controller since a moment that is marked."""

    def __init__(self, controller: ControllerProcess) -> None:
        self._controller = controller
        self._marked = -1

    def mark(self) -> None:
        """Count what comes from now on."""
        self._new_records()

    def mark_when_quiet(self) -> None:
        """The same, once the stops of what went before have come: without a motion nothing else tells them apart."""
        quiet_since_s = time.monotonic()
        while time.monotonic() - quiet_since_s < _QUIET_S:
            if any(_is_stop(record) for record in self._new_records()):
                quiet_since_s = time.monotonic()
            time.sleep(_LOOK_S)

    def first_stop_ms(self, at_s: float) -> float | None:
        """Milliseconds from a monotonic time to the first stop of the motion since the mark; None if there is none.

        A stop that came before that time counts as what it is: early.
        """
        end_s = time.monotonic() + _WITHIN_S
        while time.monotonic() < end_s:
            records = self._controller.wire(self._marked)
            launched = [record.number for record in records if record.command == _MOVE_LINEAR]
            behind = launched[-1] if launched else self._marked
            stops = [record.at_s for record in records if record.number > behind and _is_stop(record)]
            if stops:
                return (min(stops) - at_s) * 1000.0
            time.sleep(_LOOK_S)
        return None

    def _new_records(self) -> tuple[WireRecord, ...]:
        records = self._controller.wire(self._marked)
        self._marked = records[-1].number if records else self._marked
        return records


def _is_stop(record: WireRecord) -> bool:
    """A stop by dashboard or register, or the controller's own by its watchdog."""
    return record.text == "stop" or record.command == _STOP_SCRIPT or record.kind == "watchdog"

"""The controller's own log as the witness of a stop."""

from simulator.controller import ControllerProcess, WireRecord

STOP_SCRIPT = 255  # the command register that ends the control script


def is_stop(record: WireRecord) -> bool:
    """A stop by dashboard or register, or the controller's own by its watchdog."""
    return record.text == "stop" or record.command == STOP_SCRIPT or record.kind == "watchdog"


def first_stop_ms(controller: ControllerProcess, after: int, at_s: float) -> float | None:
    """Milliseconds from a monotonic time to the first stop behind a record's number; None if there is none.

    Behind it, a stop that came before that time counts as what it is: early.
    """
    launched = [record.number for record in controller.wire(after) if record.command == 3]
    behind = launched[-1] if launched else after
    stops = [record.at_s for record in controller.wire(behind) if is_stop(record)]
    return (min(stops) - at_s) * 1000.0 if stops else None

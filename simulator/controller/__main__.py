"""The process behind `ControllerProcess`: settings first, then calls, one JSON object a line; ends with its input."""

import gc
import json
import os
import signal
import sys
from contextlib import suppress
from typing import Any

from simulator.controller.codec import from_json, to_json
from simulator.controller.controller import Controller

# A real controller shares no processor with its clients: where that is allowed, their load does not delay its cycle.
# Real-time, of 1 to 99; niceness does little where the kernel shares processors out among sessions first.
_PRIORITY = 20


def main() -> None:
    """Run one controller until standard input closes."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the terminal's interrupt is for the owner, who closes the input
    with suppress(PermissionError, AttributeError):  # there is no such policy outside Linux
        os.sched_setscheduler(0, os.SCHED_RR, os.sched_param(_PRIORITY))
    first = json.loads(sys.stdin.readline())
    try:
        controller = Controller(from_json(first["settings"]))
    except OSError as error:
        _say({"error": str(error), "kind": "OSError"})
        return
    gc.freeze()  # a real controller makes no pause to look for garbage among a hundred thousand objects
    with controller:
        _say({"result": None})
        for line in sys.stdin:
            _say(_answer(controller, json.loads(line)))


def _answer(controller: Controller, request: dict[str, Any]) -> dict[str, Any]:
    try:
        return {"result": to_json(getattr(controller, request["call"])(*from_json(request["arguments"])))}
    except ValueError as error:
        return {"error": str(error), "kind": "ValueError"}


def _say(answer: dict[str, Any]) -> None:
    sys.stdout.write(json.dumps(answer) + "\n")
    sys.stdout.flush()


if __name__ == "__main__":
    main()

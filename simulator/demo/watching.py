"""Waiting for what the service observes: the newest events of a case, read until one of the wanted is there."""

import time
from typing import Any

from service.client import Case
from simulator.demo.failure import DemoFailed, failed_verdicts

Json = dict[str, Any]
_LOOK_EVERY_S = 0.05
_HELD = "safe_hold"


def await_event(case: Case, after: int, wanted: tuple[str, ...], timeout_s: float) -> Json:
    """The first of the wanted events behind sequence `after`.

    DemoFailed if the case is held first, if an image was not taken for what it was asked for, or if nothing comes.
    """
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        for event in case.room.get_list(f"/cases/{case.id}/audit?after={after}"):
            after = event["sequence"]
            if event["trigger"] in wanted:
                return event
            _check(case, event)
        time.sleep(_LOOK_EVERY_S)
    raise DemoFailed("nothing_came", f"no {' or '.join(wanted)} within {timeout_s:g} s")


def why(case: Case, trigger: str) -> str:
    """What refused the newest attempt at a trigger, interlock by interlock."""
    newest = next((one for one in case.attempts() if one["trigger"] == trigger), None)
    return failed_verdicts(newest["verdicts"]) if newest else ""


def _check(case: Case, event: Json) -> None:
    if event["state"] == _HELD:
        held_for = event["case_state"].get("held_for")
        raise DemoFailed(str(held_for), f"the case is held since {event['trigger']}")
    if event["trigger"] == "image_arrived" and event["data"]["row"] not in (3, 4):
        problem = event["data"].get("problem")
        text = why(case, "image_arrived") or f"taken as {event['data']['taken_as']}"
        raise DemoFailed("image_not_used", problem["message"] if problem else text)

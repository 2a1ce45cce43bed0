"""Waiting for what the service observes: the events of a case, followed until one of the wanted is there."""

import time
from typing import Any

from coaxial_client import Case
from simulator.demo.failure import DemoFailed, failed_verdicts

Json = dict[str, Any]
_HELD = "safe_hold"
_IN_USE = (3, 4)  # the table's rows for an image that was asked for


def await_event(case: Case, after: int, wanted: tuple[str, ...], timeout_s: float) -> Json:
    """The first of the wanted events behind sequence `after`.

    DemoFailed if the case is held before an image is in use, if the image was not taken for what it was asked for, or
    if nothing comes. What is made of an image that is in use comes during a hold too.
    """
    in_use = False
    end_s = time.monotonic() + timeout_s
    try:
        while (event := case.await_event(after=after, timeout_s=end_s - time.monotonic()))["trigger"] not in wanted:
            after = event["sequence"]
            in_use = in_use or _takes_image(case, event)
            if event["state"] == _HELD and not in_use:
                raise DemoFailed(str(case.status()["held_for"]), f"the case is held since {event['trigger']}")
    except TimeoutError:
        raise DemoFailed("nothing_came", f"no {' or '.join(wanted)} within {timeout_s:g} s") from None
    return event


def why(case: Case, trigger: str) -> str:
    """What refused the newest attempt at a trigger, interlock by interlock."""
    newest = next((one for one in case.attempts() if one["trigger"] == trigger), None)
    return failed_verdicts(newest["verdicts"]) if newest else ""


def _takes_image(case: Case, event: Json) -> bool:
    """Whether with this event an image enters the chain; DemoFailed if it came and does not."""
    if event["trigger"] != "image_arrived":
        return False
    if event["data"]["row"] in _IN_USE:
        return True
    problem = event["data"].get("problem")
    text = why(case, "image_arrived") or f"taken as {event['data']['taken_as']}"
    raise DemoFailed("image_not_used", problem["message"] if problem else text)

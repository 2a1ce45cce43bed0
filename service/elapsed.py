"""The clock of every age that a decision rests on: nobody sets it, and it goes on while the machine sleeps (H23)."""

import time


def elapsed_s() -> float:
    """Seconds since the machine was started, asleep or not.

    CLOCK_MONOTONIC, which the guard's messages are dated by, stands still in between: an image of before would be as
    young as it was, and a permit as good.
    """
    return time.clock_gettime(time.CLOCK_BOOTTIME)

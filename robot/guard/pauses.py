"""The interpreter's pauses: it searches all that a process has loaded for garbage while every thread of it waits."""

import gc


def spare_what_is_loaded() -> None:
    """Leave everything that is in memory now out of every later search: to be called once a process is up.

    A third of a million objects, as many as the service loads, took 0.7 s to search beside two busy processors, amid a
    held motion as at any other time; no precedence of a thread helps against that.
    """
    gc.freeze()

"""Processors for calculations: how many there are, and one for each process."""

import os

_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def use_one_core_for_algebra() -> None:
    """Over matrices as small as here its threads only wait for one another; to be called before numpy is loaded.

    On two cores that other work shared a registration took six times the processor time with threads.
    """
    os.environ.update(dict.fromkeys(_THREADS, "1"))


def use_one_core() -> None:
    """Leave the others to other processes; to be called before numpy is loaded, whose algebra then reads it."""
    use_one_core_for_algebra()
    import cv2

    cv2.setNumThreads(1)

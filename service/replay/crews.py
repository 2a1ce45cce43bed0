"""Who replays cases: this process, several on this machine, or the workers of a Dask cluster.

A crew is given cases whole, bytes and all, so that its members need neither the database nor its address.
"""

import os
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from contextlib import contextmanager
from itertools import islice
from multiprocessing import get_context
from typing import Any

from service.cores import use_one_core
from service.errors import ErrorCode, ServiceError
from service.replay.inputs import CaseInput, CaseReplay

# A replay beside a procedure leaves the processors to it.
_NICE = 15
# Cases that wait for each worker: enough that none waits, and few, for each is as big as its images.
_AHEAD = 2
_CONNECT_S = 10

Crew = Callable[[Iterable[CaseInput]], Iterator[CaseReplay]]


@contextmanager
def on_this_machine(workers: int) -> Iterator[Crew]:
    """So many processes; for one worker this one."""
    if workers == 1:
        yield _alone
        return
    with ProcessPoolExecutor(workers, get_context("spawn"), initializer=_settle) as pool:
        yield lambda cases: _in_turn(cases, lambda case: pool.submit(_replay, case), wait, workers)


@contextmanager
def on_a_cluster(address: str) -> Iterator[Crew]:
    """The workers of a Dask scheduler; ServiceError CLUSTER_UNAVAILABLE, or EXTRA_MISSING without `distributed`."""
    try:
        import distributed
    except ImportError as error:
        message = "a cluster needs the extra `cluster` (pip install 'coaxial[cluster]')"
        raise ServiceError(ErrorCode.EXTRA_MISSING, message) from error
    try:
        client: Any = distributed.Client(address, timeout=_CONNECT_S)  # type: ignore[no-untyped-call]  # has no types
    except (OSError, ValueError) as error:
        raise ServiceError(ErrorCode.CLUSTER_UNAVAILABLE, f"no scheduler answers at {address}") from error
    with client:
        workers = max(1, sum(client.nthreads().values()))

        def submit(case: CaseInput) -> Any:
            # Scattered first: a scheduler is no place for images.
            return client.submit(_replay, client.scatter(case, hash=False), pure=False)

        yield lambda cases: _in_turn(cases, submit, distributed.wait, workers)


def _alone(cases: Iterable[CaseInput]) -> Iterator[CaseReplay]:
    yield from map(_replay, cases)


def _replay(case: CaseInput) -> CaseReplay:
    # Imported where it is computed: image work takes a second to load.
    from service.replay.computing import replay

    return replay(case)


def _settle() -> None:
    os.nice(_NICE)
    use_one_core()


def _in_turn(
    cases: Iterable[CaseInput], submit: Callable[[CaseInput], Any], wait_for: Callable[..., Any], workers: int
) -> Iterator[CaseReplay]:
    """Results as they come, with only so many cases under way as keep every worker busy."""
    left = iter(cases)
    running = {submit(case) for case in islice(left, workers * _AHEAD)}
    while running:
        done, running = wait_for(running, return_when=FIRST_COMPLETED)
        for future in done:
            running |= {submit(case) for case in islice(left, 1)}
            yield future.result()

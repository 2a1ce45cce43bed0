"""The inside of the image worker process: one job at a time from a pipe, within a memory limit."""

import os
import resource
import signal
from multiprocessing.connection import Connection
from typing import Any

from service.structured_log import configure_log, exception_places

# Behind the service, so that a busy image never delays a heartbeat or a stop (H32), and not far behind: with 10 a
# registration took 1.7 s beside as many busy processes as cores (`make bench-service`).
_NICENESS = 2
_OPENCV_NO_MEMORY = -4

OK, OUT_OF_MEMORY, FAILED = "ok", "out_of_memory", "failed"


def serve_jobs(pipe: Connection, memory_bytes: int, jobs_module: str) -> None:
    """Import `jobs_module` (it has JOBS), say so, then work until the pipe closes; the parent's death closes it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the service's to handle
    configure_log()
    os.nice(_NICENESS)
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    jobs = __import__(jobs_module, fromlist=["JOBS"]).JOBS
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    try:
        pipe.send((OK, None))
        while True:
            name, arguments = pipe.recv()
            pipe.send(_work(jobs[name], arguments))
    except (EOFError, ConnectionError):  # the parent is gone; so is whoever waited for an answer
        return


def _work(job: Any, arguments: tuple[Any, ...]) -> tuple[str, Any]:
    try:
        return OK, job(*arguments)
    except MemoryError:
        return OUT_OF_MEMORY, None
    except Exception as error:  # noqa: BLE001  the parent turns it into a typed fault; the process goes on
        if getattr(error, "code", None) == _OPENCV_NO_MEMORY:
            return OUT_OF_MEMORY, None
        return FAILED, exception_places(error)

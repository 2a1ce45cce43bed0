"""Image work in a process of its own, with a deadline and a memory limit; never on the event loop.

Answers are JSON-able and as the command line prints them: `{"status": "refused", "reason": {...}}` where the image or
the geometry says no. ServiceError (VISION_DEADLINE, VISION_CRASHED, VISION_OUT_OF_MEMORY) is for work that failed.
"""

import asyncio
import multiprocessing
import time
from concurrent.futures import ThreadPoolExecutor
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any

import structlog

from service import vision_process
from service.errors import ErrorCode, ServiceError
from service.operations.counts import count_image_work
from service.settings import VisionSettings

_log = structlog.get_logger(__name__)
Json = dict[str, Any]
Matrix = list[list[float]]

STARTING = "vision_starting"
# Pictures for screens that take turns here, in memory: however many are asked for, a registration waits for few.
_SHOWN_AT_ONCE = 2

# A spawned process shares neither locks nor the guard's pipe with the service; a forked one would.
_SPAWN = multiprocessing.get_context("spawn")


class VisionWorker:
    """One spawned process; jobs wait for one another. Started ahead or at the first job, again after it ended."""

    def __init__(self, settings: VisionSettings, jobs_module: str = "service.vision_jobs") -> None:
        self._settings = settings
        self._jobs_module = jobs_module
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="vision-worker")
        self.turns_to_show = asyncio.Semaphore(_SHOWN_AT_ONCE)
        self._process: SpawnProcess | None = None
        self._pipe: Connection | None = None
        self._why_down: str | None = None
        self._closing = False

    @property
    def why_down(self) -> str | None:
        """Why image work would have to wait: it starts, or the code with which it did not; None where it is not so."""
        return self._why_down

    @property
    def pid(self) -> int | None:
        """The process now at work or waiting for it."""
        return self._process.pid if self._process else None

    async def start(self) -> None:
        """Start the process ahead of the first job, so that the first image does not pay for the imports.

        ServiceError where it does not start; the first job tries again.
        """
        await asyncio.get_running_loop().run_in_executor(self._thread, self._running_pipe)

    async def close(self) -> None:
        """End the process, in the middle of a job too."""
        self._closing = True
        process = self._process
        if process is not None:
            process.kill()
        await asyncio.to_thread(self._thread.shutdown)
        self._end()

    async def register(self, image: bytes, guide: bytes, carm: bytes, handedness_proved: bool = False) -> Json:
        """`coaxial register` on bytes; the image's path is left out."""
        return await self.run("register", image, guide, carm, handedness_proved)

    async def target(self, registration: Json, raw_px: tuple[float, float], depth_mm: float, errors: Json) -> Json:
        """`coaxial target` from a registration's JSON, with what the next image will see to have moved."""
        return await self.run("target", registration, raw_px, depth_mm, errors)

    async def handedness(
        self, images: tuple[bytes, bytes], guide: bytes, carm: bytes, before_from_after: Matrix, errors: Json
    ) -> Json:
        """The second image's registration, if the two prove that nothing mirrors them."""
        return await self.run("handedness", *images, guide, carm, before_from_after, errors)

    async def evaluate(
        self, image: bytes, guide: bytes, carm: bytes, raw_px: tuple[float, float], depth_mm: float, before: Json
    ) -> Json:
        """`coaxial evaluate` on bytes, held against the image before; `registration` is for a correction."""
        return await self.run("evaluate", image, guide, carm, raw_px, depth_mm, before)

    async def carm_angles(self, entry_mm: tuple[float, ...], target_mm: tuple[float, ...], position: str) -> Json:
        """`coaxial plan-carm`."""
        return await self.run("carm_angles", entry_mm, target_mm, position)

    async def run(self, job: str, *arguments: Any) -> Json:
        """Any job by name; ServiceError where the work failed."""
        return await asyncio.get_running_loop().run_in_executor(self._thread, self._timed, job, arguments)

    def _timed(self, job: str, arguments: tuple[Any, ...]) -> Json:
        started_s, failed = time.monotonic(), True
        try:
            answer = self._exchange(job, arguments)
            failed = False
        finally:
            count_image_work(job, time.monotonic() - started_s, failed=failed)
        return answer

    def _exchange(self, job: str, arguments: tuple[Any, ...]) -> Json:
        pipe = self._running_pipe()
        try:
            pipe.send((job, arguments))
            outcome, answer = self._receive(pipe, self._settings.deadline_s, job)
        except (EOFError, OSError) as error:
            self._end()
            raise self._fault(ErrorCode.VISION_CRASHED, job, "the image worker died") from error
        if outcome == vision_process.OUT_OF_MEMORY:
            raise self._fault(
                ErrorCode.VISION_OUT_OF_MEMORY, job, "the image needs too much memory", self._settings.memory_bytes
            )
        if outcome == vision_process.FAILED:
            _log.error("vision_job_failed", job=job, error=answer)
            raise self._fault(ErrorCode.VISION_CRASHED, job, "the image worker failed")
        result: Json = answer
        return result

    def _receive(self, pipe: Connection, deadline_s: float, job: str) -> tuple[str, Any]:
        if not pipe.poll(deadline_s):
            self._end()
            raise self._fault(ErrorCode.VISION_DEADLINE, job, "the image took too long, s", deadline_s)
        outcome, answer = pipe.recv()
        return outcome, answer

    def _running_pipe(self) -> Connection:
        if self._pipe is None or self._process is None or not self._process.is_alive():
            self._end()
            self._why_down = STARTING
            try:
                self._pipe = self._start_process()
            except ServiceError as error:
                self._why_down = error.code
                raise
            self._why_down = None
        return self._pipe

    def _start_process(self) -> Connection:
        ours, theirs = _SPAWN.Pipe()
        arguments = (theirs, self._settings.memory_bytes, self._jobs_module)
        process = _SPAWN.Process(target=vision_process.serve_jobs, args=arguments, daemon=True)
        try:
            process.start()
            self._process = process
            theirs.close()  # so that the process's death closes the pipe
            self._receive(ours, self._settings.start_deadline_s, "start")
        except (EOFError, OSError) as error:
            self._end()
            raise self._fault(ErrorCode.VISION_CRASHED, "start", "the image worker did not start") from error
        return ours

    def _end(self) -> None:
        if self._process is not None:
            self._process.kill()
            self._process.join()
            self._process.close()
            self._process = None
        if self._pipe is not None:
            self._pipe.close()
            self._pipe = None

    def _fault(self, code: ErrorCode, job: str, message: str, limit: float | None = None) -> ServiceError:
        if not self._closing:  # what ends with the service is no fault
            _log.error("vision_worker_fault", code=code, job=job)
        return ServiceError(code, message, limit=limit)

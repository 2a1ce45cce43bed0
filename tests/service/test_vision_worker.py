"""The image worker: a real spawned process that is slow, greedy, wrong or killed on demand."""

import asyncio
import os
import signal
import time
from pathlib import Path

import pytest
from structlog.testing import capture_logs

from service.errors import ErrorCode, ServiceError
from service.settings import VisionSettings
from service.vision_worker import STARTING, VisionWorker
from tests.waiting import until

_JOBS = """
import os, time
def pid(): return {"pid": os.getpid()}
def sleep(seconds): time.sleep(seconds); return {"slept": seconds}
def eat(size): return {"eaten": len(bytearray(size))}
def fail(): raise ZeroDivisionError("inside")
def die(): os._exit(7)
JOBS = {job.__name__: job for job in (pid, sleep, eat, fail, die)}
"""


@pytest.fixture
def jobs_module(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    (tmp_path / "trial_jobs.py").write_text(_JOBS)
    monkeypatch.syspath_prepend(tmp_path)  # a spawned process gets the parent's path
    return "trial_jobs"


@pytest.fixture
def run(jobs_module):
    """Run a coroutine function with a worker of little patience, and end the worker after it."""

    def run_with(trial, deadline_s=0.5, memory_bytes=1_000_000_000):
        async def whole():
            settings = VisionSettings(deadline_s=deadline_s, memory_bytes=memory_bytes)
            worker = VisionWorker(settings, jobs_module)
            try:
                return await trial(worker)
            finally:
                await worker.close()

        return asyncio.run(whole())

    return run_with


async def _code(job) -> str:
    with pytest.raises(ServiceError) as refusal:
        await job
    return refusal.value.code


def test_work_is_done_elsewhere_and_by_the_same_process(run):
    async def trial(worker):
        return [(await worker.run("pid"))["pid"] for _ in range(3)]

    assert len({*run(trial)}) == 1
    assert os.getpid() not in run(trial)


def test_a_job_over_its_deadline_is_killed_and_the_next_one_works(run):
    async def trial(worker):
        await worker.start()
        before, started_s = worker.pid, time.monotonic()
        code = await _code(worker.run("sleep", 60))
        return code, time.monotonic() - started_s, before, (await worker.run("pid"))["pid"]

    code, took_s, before, after = run(trial)
    assert code == ErrorCode.VISION_DEADLINE
    assert took_s < 2.0  # deadline 0.5 s, and the kill
    assert before != after
    with pytest.raises(ProcessLookupError):
        os.kill(before, 0)


@pytest.mark.hazard("H32")
def test_a_greedy_job_is_refused_and_the_process_goes_on(run):
    async def trial(worker):
        first = (await worker.run("pid"))["pid"]
        return await _code(worker.run("eat", 2_000_000_000)), first == (await worker.run("pid"))["pid"]

    assert run(trial) == (ErrorCode.VISION_OUT_OF_MEMORY, True)


@pytest.mark.parametrize("job", ["fail", "die"])
def test_a_job_that_fails_is_a_typed_fault_and_the_next_one_works(run, job):
    async def trial(worker):
        return await _code(worker.run(job)), "pid" in await worker.run("pid")

    assert run(trial) == (ErrorCode.VISION_CRASHED, True)


def test_a_process_that_was_killed_while_idle_is_replaced(run):
    async def trial(worker):
        await worker.start()
        os.kill(worker.pid, signal.SIGKILL)
        await asyncio.sleep(0.2)
        return await worker.run("pid")

    assert "pid" in run(trial)


@pytest.mark.hazard("H32")
def test_the_event_loop_goes_on_during_a_job(run):
    async def trial(worker):
        await worker.start()
        job = asyncio.create_task(worker.run("sleep", 0.4))
        longest_s, last_s = 0.0, time.monotonic()
        while not job.done():
            await asyncio.sleep(0.005)
            longest_s, last_s = max(longest_s, time.monotonic() - last_s), time.monotonic()
        return longest_s

    assert run(trial) < 0.1  # a heartbeat's budget is 0.2 s


def test_closing_ends_a_running_job(run):
    async def trial(worker):
        await worker.start()
        job = asyncio.create_task(worker.run("sleep", 60))
        await asyncio.sleep(0.1)
        started_s = time.monotonic()
        await worker.close()
        return await _code(job), time.monotonic() - started_s

    code, took_s = run(trial, deadline_s=30)
    assert code == ErrorCode.VISION_CRASHED
    assert took_s < 2.0


def test_a_worker_that_cannot_start_says_so_until_it_does(run):
    async def trial(worker):
        good, worker._jobs_module = worker._jobs_module, "no_such_module"
        told = [worker.why_down, await _code(worker.start()), worker.why_down, await _code(worker.run("pid"))]
        worker._jobs_module = good
        await worker.run("pid")
        return [*told, worker.why_down]

    crashed = ErrorCode.VISION_CRASHED
    assert run(trial) == [None, crashed, crashed, crashed, None]


def test_a_worker_that_starts_is_waited_for_by_the_first_job_and_says_so(run):
    async def trial(worker):
        starting = asyncio.create_task(worker.start())
        await asyncio.to_thread(until, lambda: worker.why_down is not None)
        told = worker.why_down
        first = (await worker.run("pid"))["pid"]
        await starting
        return told, worker.why_down, first == worker.pid

    assert run(trial) == (STARTING, None, True)


def test_closing_ends_a_start_without_calling_that_a_fault(run, tmp_path):
    (tmp_path / "slow_jobs.py").write_text("import time; time.sleep(60)")

    async def trial(worker):
        worker._jobs_module = "slow_jobs"
        starting = asyncio.create_task(worker.start())
        await asyncio.to_thread(until, lambda: worker.pid is not None)
        started_s = time.monotonic()
        await worker.close()
        return await _code(starting), time.monotonic() - started_s

    with capture_logs() as logged:
        code, took_s = run(trial)
    assert code == ErrorCode.VISION_CRASHED
    assert took_s < 2.0
    assert logged == []

"""Registering many images: on all cores, answered in the order in which they were given."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from dataclasses import dataclass
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from service.cli.streams import DONE, REFUSED, UNUSABLE, complain, end_unusable, read_one_of_many, refusal_line
from service.cores import cores, use_one_core

if TYPE_CHECKING:
    from vision.devices import CArm, Guide

_LEAST_IMAGES = 4  # for which starting processes, a second each, pays
_PROGRESS_STEPS = 10


@dataclass(frozen=True, slots=True)
class Job:
    """One image and what to register it with."""

    path: Path
    frame: int | None
    guide: "Guide"
    carm: "CArm"
    method: str


@dataclass(frozen=True, slots=True)
class Answer:
    """The JSON object of one image, and the exit status that it asks for."""

    line: dict[str, Any]
    status: int


def answers(jobs: Sequence[Job]) -> Iterator[Answer]:
    """The answer to each job, in their order; on stderr each file that cannot be read, and progress where many are."""
    for job, one in zip(jobs, _computed(jobs), strict=True):
        if one.status == UNUSABLE:
            complain(job.path, one.line["reason"]["message"])
        yield one


def _computed(jobs: Sequence[Job]) -> Iterator[Answer]:
    processes = min(cores(), len(jobs))
    if len(jobs) < _LEAST_IMAGES or processes < 2:
        yield from map(answer, jobs)
        return
    with ProcessPoolExecutor(processes, get_context("spawn"), initializer=use_one_core) as pool:
        step, done = max(1, len(jobs) // _PROGRESS_STEPS), 0
        try:
            for done, result in enumerate(pool.map(answer, jobs), start=1):
                yield result
                if done % step == 0:
                    typer.echo(f"{done} of {len(jobs)} images", err=True)
        except BrokenProcessPool:
            end_unusable(jobs[done].path, "not done: a process that registers images was killed. Is memory short?")


def answer(job: Job) -> Answer:
    """Register one image."""
    from vision.refusal import Refusal
    from vision.registered import Method
    from vision.registration import register
    from vision.registration_json import to_json

    identity, image, status = read_one_of_many(job.path, job.frame)
    if isinstance(image, Refusal):
        return Answer(refusal_line(image, identity), status)
    result = register(image, job.guide, job.carm, Method(job.method))
    if isinstance(result, Refusal):
        return Answer(refusal_line(result, identity), REFUSED)
    return Answer(to_json(result, str(job.path)), DONE)

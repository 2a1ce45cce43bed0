"""What the service counts and times for Prometheus; every label has a fixed set of values, none says whose case it is.

Imported by whatever counts, and so imports nothing of the service.
"""

from collections.abc import Sequence

from prometheus_client import Counter, Histogram

from workflow.interlocks import INTERLOCKS
from workflow.triggers import Trigger
from workflow.verdicts import Verdict

# A press on a loopback connection is on the wire in milliseconds; the budget on a crowded machine is 60 ms.
_STOP_BUCKETS_S = (0.001, 0.002, 0.005, 0.01, 0.02, 0.04, 0.06, 0.1, 0.2, 0.5, 1.0)
# Registering takes some 0.3 s; a job is ended at 20 s.
_JOB_BUCKETS_S = (0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 2.0, 5.0, 10.0, 20.0)

_DECISIONS = Counter("coaxial_decisions", "What was asked and observed, by how it was answered.", ["trigger", "answer"])
_VERDICTS = Counter("coaxial_verdicts", "Verdicts of each interlock.", ["interlock", "hazard", "verdict"])
_STOPS = Histogram(
    "coaxial_stop_latency_seconds", "From a stop's request until the guard writes it.", buckets=_STOP_BUCKETS_S
)
_JOBS = Histogram("coaxial_image_work_seconds", "Image work, by job.", ["job"], buckets=_JOB_BUCKETS_S)
_FAILED_JOBS = Counter("coaxial_image_work_failures", "Image work that ended by its deadline or a fault.", ["job"])
# service.vision_jobs.JOBS, without what they import; a test holds the two together.
IMAGE_WORK = (
    "register",
    "annotate",
    "handedness",
    "target",
    "evaluate",
    "carm_angles",
    "echo",
    "identify",
    "pixels",
    "overlay",
    "draw_figures",
    "typeset",
)


def _begin_at_zero() -> None:
    """Show what an alarm may ask for before it happens: a series that begins at one has not increased."""
    for job in IMAGE_WORK:
        _JOBS.labels(job)
        _FAILED_JOBS.labels(job)
    for code, interlock in INTERLOCKS.items():
        for verdict in ("passed", "refused"):
            _VERDICTS.labels(code, interlock.hazard, verdict)


_begin_at_zero()


def count_decision(trigger: Trigger, answer: str, verdicts: Sequence[Verdict]) -> None:
    """A request, fact or observation that was decided: the outcome or the code of the refusal, and each verdict."""
    _DECISIONS.labels(trigger.value, answer).inc()
    for verdict in verdicts:
        _VERDICTS.labels(verdict.code, verdict.hazard, "passed" if verdict.passed else "refused").inc()


def count_stop(latency_s: float) -> None:
    """A stop went out, so long after it was asked for."""
    _STOPS.observe(latency_s)


def count_image_work(job: str, duration_s: float, *, failed: bool) -> None:
    """A job of the image worker ended; one that failed says nothing of how long such work takes."""
    if failed:
        _FAILED_JOBS.labels(job).inc()
    else:
        _JOBS.labels(job).observe(duration_s)

"""The metrics' own listener: silent unless the settings name a port; nobody there is asked who they are."""

from collections.abc import AsyncIterator, Iterator
from contextlib import asynccontextmanager

import structlog
from fastapi import FastAPI
from prometheus_client import REGISTRY, start_http_server
from prometheus_client.metrics_core import GaugeMetricFamily, Metric
from prometheus_client.registry import Collector

from service.conductor.conductor import Conductor
from service.errors import ErrorCode, ServiceError
from service.operations.health import free_bytes
from service.pacs.outbox import count_undelivered
from service.parts import Parts
from workflow.states import State

_log = structlog.get_logger(__name__)


@asynccontextmanager
async def measuring(app: FastAPI, parts: Parts) -> AsyncIterator[None]:
    """Serve the metrics until the end of the block; nothing to do where the settings name no port."""
    settings = parts.settings.metrics
    if settings.port is None:
        yield
        return
    try:
        server, thread = start_http_server(settings.port, settings.host)
    except OSError as error:
        message = f"cannot serve metrics on {settings.host}:{settings.port} ({error.strerror})"
        raise ServiceError(ErrorCode.SETTINGS_REFUSED, message) from error
    room = _Room(app.state.conductor)
    REGISTRY.register(room)
    try:
        yield
    finally:
        REGISTRY.unregister(room)
        server.shutdown()
        server.server_close()
        thread.join()


class _Room(Collector):
    """What is read when Prometheus asks: the open case's state, the guard's age, the disk."""

    def __init__(self, conductor: Conductor) -> None:
        self._conductor = conductor

    def describe(self) -> Iterator[Metric]:
        """The families, without reading anything."""
        yield from (_states(None), _undelivered(None), _guard_age(None), _free(None))

    def collect(self) -> Iterator[Metric]:
        """The same, read; what cannot be read is left out."""
        try:
            case_id = self._conductor.open_case()
            yield _states(None if case_id is None else self._conductor.case_of(case_id).state)
            with self._conductor.parts.database.read() as connection:
                yield _undelivered(count_undelivered(connection))
        except ServiceError as error:
            _log.error("metrics_incomplete", code=error.code)
        yield _guard_age(self._conductor.bridge.guard_age_s)
        yield _free(free_bytes(self._conductor.parts.settings))


def _states(state: State | None) -> Metric:
    """One where the open case is, zero elsewhere; all zero without an open case."""
    family = GaugeMetricFamily("coaxial_case_state", "State of the room's open case.", labels=["state"])
    for one in State:
        family.add_metric([one.value], float(one is state))
    return family


def _undelivered(count: int | None) -> Metric:
    family = GaugeMetricFamily("coaxial_undelivered_objects", "Objects of closed cases that no archive accepted yet.")
    if count is not None:
        family.add_metric([], float(count))
    return family


def _guard_age(age_s: float | None) -> Metric:
    family = GaugeMetricFamily("coaxial_guard_age_seconds", "Age of the guard's newest word; none without an arm.")
    if age_s is not None:
        family.add_metric([], age_s)
    return family


def _free(size: int | None) -> Metric:
    family = GaugeMetricFamily("coaxial_free_bytes", "Free space on the data folder's disk.")
    if size is not None:
        family.add_metric([], float(size))
    return family

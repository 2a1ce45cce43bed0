"""Which tests run which line, and how long each takes: one run of all of them under coverage."""

import gc
import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import _lru_cache_wrapper
from pathlib import Path
from types import FunctionType

import pytest
from coverage import Coverage, CoverageData

from benchmarks.mutation.forks import HarnessError, Outcome, Status, forked
from benchmarks.mutation.mutants import Mutant, source_of
from benchmarks.mutation.packages import Package

_PROCESSOR_S = 1200  # all tests of a package, traced


@dataclass(frozen=True, slots=True)
class Reach:
    """Tests in the order of what they take.

    Attributes
    ----------
    tests : tuple of str
    of_line : dict
        By module and line: the tests that run it, "" among them where it runs on import.
    """

    tests: tuple[str, ...]
    of_line: dict[str, dict[int, frozenset[str]]]

    def of(self, mutant: Mutant) -> frozenset[str]:
        """Everything that runs a line of the mutant."""
        lines = self.of_line.get(mutant.module, {})
        return frozenset().union(*(lines.get(line, frozenset()) for line in mutant.lines))


class _Recorder:
    """A plugin of pytest: each test is a context of its own, its time and failures are kept."""

    def __init__(self, coverage: Coverage, files: Sequence[str]) -> None:
        self._coverage = coverage
        self._files = frozenset(files)
        self._caches: list[_lru_cache_wrapper[object]] = []
        self.seconds: dict[str, float] = {}
        self.failed: list[str] = []

    def pytest_collection_finish(self) -> None:
        """What a cache answers no test seems to reach, so each begins with empty ones."""
        wrappers = (thing for thing in gc.get_objects() if isinstance(thing, _lru_cache_wrapper))
        self._caches = [one for one in wrappers if self._is_own(one.__wrapped__)]

    def _is_own(self, function: object) -> bool:
        return isinstance(function, FunctionType) and function.__code__.co_filename in self._files

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_protocol(self, item: pytest.Item) -> Iterator[None]:
        for cache in self._caches:
            cache.cache_clear()
        self._coverage.switch_context(item.nodeid)
        result = yield
        self._coverage.switch_context("")
        return result

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self.seconds[report.nodeid] = self.seconds.get(report.nodeid, 0.0) + report.duration
        self.failed += [report.nodeid] if report.failed else []


def reach_of(package: Package, folder: Path, digest: str) -> Reach:
    """Measured, or as it was kept for the same tests and modules."""
    kept, times = folder / f"{package.name}-{digest}.coverage", folder / f"{package.name}-{digest}.json"
    if not times.exists():
        forked(lambda: _measure(package, kept, times), _PROCESSOR_S)
    seconds: dict[str, float] = json.loads(times.read_text())
    data = CoverageData(str(kept))
    data.read()
    of_line = {
        module: {line: frozenset(tests) for line, tests in data.contexts_by_lineno(str(source_of(module))).items()}
        for module in package.modules
    }
    return Reach(tuple(sorted(seconds, key=seconds.__getitem__)), of_line)


def _measure(package: Package, kept: Path, times: Path) -> Outcome:
    files = [str(source_of(module)) for module in package.modules]
    coverage = Coverage(data_file=str(kept), include=files, config_file=False)
    recorder = _Recorder(coverage, files)
    coverage.start()
    ended = pytest.main(package.options, plugins=[recorder, PatientHypothesis()])
    coverage.stop()
    coverage.save()
    if ended != pytest.ExitCode.OK:
        raise HarnessError(f"without any change the tests end with {ended}: {recorder.failed}")
    times.write_text(json.dumps(recorder.seconds))
    return Outcome(Status.SURVIVED)


class PatientHypothesis:
    """A plugin of pytest: no example is too slow where the processors are shared."""

    def pytest_sessionstart(self) -> None:
        """After the tests' own profile is loaded."""
        from hypothesis import HealthCheck, settings  # not before pytest has rewritten its plugin

        settings.register_profile("patient", settings(), suppress_health_check=list(HealthCheck), deadline=None)
        settings.load_profile("patient")

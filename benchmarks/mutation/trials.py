"""Mutants tried: in place where a function's body is changed, else by importing all of the project anew."""

import json
import os
import signal
from collections.abc import Iterator, Sequence
from functools import partial

import pytest

from benchmarks.mutation.forks import HarnessError, Outcome, Status, forked, leave, quiet
from benchmarks.mutation.loading import Functions, change_in_place, forget_own_modules, functions_by_code, load_changed
from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.packages import Package
from benchmarks.mutation.reach import PatientHypothesis, Reach

_Trial = tuple[Mutant, Outcome]


class _FirstFailure:
    """A plugin of pytest: the first failure ends the fork."""

    def pytest_collectreport(self, report: pytest.CollectReport) -> None:
        if report.failed:
            leave(Outcome(Status.KILLED, report.nodeid))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.failed:
            leave(Outcome(Status.KILLED, report.nodeid))


class _InOrder(_FirstFailure):
    """These tests, in this order."""

    def __init__(self, order: Sequence[str]) -> None:
        self._places = {name: place for place, name in enumerate(order)}

    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        known = [item for item in items if item.nodeid in self._places]
        items[:] = sorted(known, key=lambda item: self._places[item.nodeid])


class _InPlace(_FirstFailure):
    """Instead of running the tests, a fork for each mutant runs those that reach it."""

    def __init__(self, mutants: Sequence[Mutant], reach: Reach, told_to: int) -> None:
        self._mutants, self._reach, self._told_to = mutants, reach, told_to

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        items = {item.nodeid: item for item in session.items}
        functions = functions_by_code()
        for number, mutant in enumerate(self._mutants):
            reaching = self._reach.of(mutant)
            chosen = [items[name] for name in self._reach.tests if name in reaching]
            outcome = forked(partial(_run_in_place, mutant, functions, chosen))
            os.write(self._told_to, f"{json.dumps([number, outcome.status, outcome.by])}\n".encode())
        return True


def tried(package: Package, mutants: Sequence[Mutant], reach: Reach) -> Iterator[_Trial]:
    """Every mutant with what became of it; what is changed in place comes first, since it takes a tenth of the time."""
    warm(package)
    reaching = {mutant.key: reach.of(mutant) for mutant in mutants}
    unreached = [mutant for mutant in mutants if mutant.in_function and not reaching[mutant.key]]
    in_place = [
        mutant for mutant in mutants if mutant.in_function and reaching[mutant.key] and "" not in reaching[mutant.key]
    ]
    done = {mutant.key for mutant in unreached}
    yield from ((mutant, Outcome(Status.UNREACHED)) for mutant in unreached)
    for mutant, outcome in _tried_in_place(package, in_place, reach):
        if outcome.status is not Status.ELSEWHERE:
            done.add(mutant.key)
            yield mutant, outcome
    yield from _tried_anew(package, [mutant for mutant in mutants if mutant.key not in done], reach)


def warm(package: Package) -> None:
    """Load what the tests load, then forget what is this project's own."""
    terminal = os.dup(1), os.dup(2)
    quiet()
    pytest.main([*package.options, "--collect-only"])
    for place, kept in enumerate(terminal, 1):
        os.dup2(kept, place)
        os.close(kept)
    forget_own_modules()


def _tried_in_place(package: Package, mutants: Sequence[Mutant], reach: Reach) -> Iterator[_Trial]:
    """From one process that has collected the tests."""
    if not mutants:
        return
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        quiet()
        pytest.main(package.options, plugins=[_InPlace(mutants, reach, writing), PatientHypothesis()])
        os._exit(0)
    os.close(writing)
    left = len(mutants)
    try:
        with os.fdopen(reading) as lines:
            for line in lines:
                number, status, by = json.loads(line)
                left -= 1
                yield mutants[number], Outcome(Status(status), by)
    finally:
        os.kill(child, signal.SIGTERM)  # it may have mutants left, where nobody asks for more
        os.waitpid(child, 0)
    if left:
        raise HarnessError(f"the process that forks ended with {left} of {len(mutants)} mutants left")


def _run_in_place(mutant: Mutant, functions: Functions, chosen: Sequence[pytest.Item]) -> Outcome:
    if not change_in_place(mutant, functions):
        return Outcome(Status.ELSEWHERE)
    for item, following in zip(chosen, [*chosen[1:], None], strict=True):
        item.config.hook.pytest_runtest_protocol(item=item, nextitem=following)
    return Outcome(Status.SURVIVED)


def _tried_anew(package: Package, mutants: Sequence[Mutant], reach: Reach) -> Iterator[_Trial]:
    if mutants and forked(partial(_run_anew, package, None, reach)).status is not Status.SURVIVED:
        raise HarnessError("a test fails without any change")
    for mutant in mutants:
        yield mutant, forked(partial(_run_anew, package, mutant, reach))


def _run_anew(package: Package, mutant: Mutant | None, reach: Reach) -> Outcome:
    """What runs the line first, then everything: a constant of one module is used in others."""
    reaching = reach.of(mutant) if mutant else frozenset()
    ended = load_changed(mutant) if mutant else None
    if ended is not None:
        return ended
    order = sorted(reach.tests, key=lambda name: name not in reaching)
    passed = pytest.main(package.options, plugins=[_InOrder(order), PatientHypothesis()]) == pytest.ExitCode.OK
    return Outcome(Status.SURVIVED) if passed else Outcome(Status.KILLED, "no test can be loaded")

"""What became of each mutant, published beside the page: a letter for each, module by module in the order of its lines.

A module's letters count as long as it has the same text and the same mutants.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from hashlib import sha256
from itertools import groupby
from operator import attrgetter
from pathlib import Path

from benchmarks.mutation.forks import Status
from benchmarks.mutation.mutants import Mutant
from benchmarks.mutation.packages import digest_of_module
from service.whole_file import whole_file

_LETTERS = {
    Status.KILLED: "k",
    Status.ENDLESS: "e",
    Status.STILLBORN: "b",
    Status.SURVIVED: "s",
    Status.UNREACHED: "u",
}
_STATUSES = {letter: status for status, letter in _LETTERS.items()}
_FINAL = (Status.KILLED, Status.ENDLESS, Status.STILLBORN)
_OTHER_TESTS = "o"  # survived, but not these tests
_NOT_TRIED = "."


@dataclass(frozen=True, slots=True)
class Result:
    """What became of one mutant, and with which tests."""

    status: Status
    tests: str

    def is_settled(self, tests: str) -> bool:
        """What no test noticed may be noticed once a test is another."""
        return self.status in _FINAL or self.tests == tests


Modules = dict[str, dict[str, str]]  # of one package, by name
Packages = dict[str, Modules]  # by name


def read(path: Path) -> Packages:
    """Everything that is published."""
    packages: Packages = json.loads(path.read_text()) if path.exists() else {}
    return packages


def write(path: Path, packages: Packages) -> None:
    """A line for each module."""
    parts = (
        f' "{name}": {{\n'
        + ",\n".join(f'  "{module}": {json.dumps(line)}' for module, line in modules.items())
        + "\n }"
        for name, modules in packages.items()
        if modules
    )
    with whole_file(path) as new:
        new.write_text("{\n" + ",\n".join(parts) + "\n}\n")


def results(modules: Modules, mutants: Sequence[Mutant]) -> dict[str, Result]:
    """By mutant, of one package."""
    found = {}
    for module, of_module in _by_module(mutants):
        line = modules.get(module, {})
        if line.get("code") == _code(module, of_module):
            for mutant, letter in zip(of_module, line["outcomes"], strict=True):
                if letter != _NOT_TRIED:
                    status = _STATUSES.get(letter, Status.SURVIVED)
                    found[mutant.key] = Result(status, "" if letter == _OTHER_TESTS else line["tests"])
    return found


def lines(found: Mapping[str, Result], mutants: Sequence[Mutant], tests: str) -> Modules:
    """The same as it is published, by module; with which tests says what is to be tried again."""
    modules = {}
    for module, of_module in _by_module(mutants):
        outcomes = "".join(_letter(found.get(mutant.key), tests) for mutant in of_module)
        if outcomes.strip(_NOT_TRIED):
            modules[module] = {"code": _code(module, of_module), "tests": tests, "outcomes": outcomes}
    return modules


def _letter(result: Result | None, tests: str) -> str:
    if result is None:
        return _NOT_TRIED
    return _LETTERS[result.status] if result.is_settled(tests) else _OTHER_TESTS


def _by_module(mutants: Sequence[Mutant]) -> Iterator[tuple[str, list[Mutant]]]:
    for module, of_module in groupby(mutants, attrgetter("module")):
        yield module, list(of_module)


def _code(module: str, mutants: Sequence[Mutant]) -> str:
    """Another one where the text is, or what is changed in it."""
    keys = "\n".join(mutant.key for mutant in mutants)
    return sha256(f"{digest_of_module(module)}\n{keys}".encode()).hexdigest()[:12]

"""One thing taken out of the rules or the guard by a plugin of pytest: which test fails first, if any does?"""

import os
import subprocess
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_FAILED = 1  # pytest's exit status where a test failed; 2 and above mean that it could not run


@dataclass(frozen=True, slots=True)
class Removal:
    """What takes something out, and the tests that should miss it.

    `not_counted` is an expression of tests that take something out by themselves.
    """

    plugin: str
    variable: str  # of the environment; its value says what to take out
    tests: tuple[str, ...]
    not_counted: str = ""

    @property
    def modules(self) -> tuple[str, ...]:
        """The plugin and the tests, as they are imported."""
        return (self.plugin, *(test.removesuffix(".py").replace("/", ".") for test in self.tests))


def first_failure(removal: Removal, taken_out: str) -> str | None:
    """The first test that fails; None if none does."""
    deselected = ["-k", f"not {removal.not_counted}"] if removal.not_counted else []
    command = [sys.executable, "-m", "pytest", "-x", "--tb=no", "-p", removal.plugin, *deselected, *removal.tests]
    environment = os.environ | {removal.variable: taken_out}
    run = subprocess.run(command, env=environment, capture_output=True, text=True)
    if run.returncode == 0:
        return None
    if run.returncode != _FAILED:
        raise RuntimeError(run.stdout + run.stderr)
    failed = next(line for line in run.stdout.splitlines() if line.startswith("FAILED "))
    return failed.removeprefix("FAILED ").split(" - ")[0]


def trials(removal: Removal, names: Sequence[str], _inputs: Path, numbers: Sequence[int]) -> Iterator[dict[str, Any]]:
    """For the evidence: a number is the place of a name."""
    for number in numbers:
        failed = first_failure(removal, names[number])
        kind = "missed by a test" if failed else "missed by none"
        yield {"number": number, "kind": kind, "bad": failed is None, "taken_out": names[number], "test": failed}


def take_out_each(removal: Removal, names: Sequence[str], what: str) -> int:
    """Print a line for each, then how many were missed; the exit status, 1 where one was not."""
    survived = 0
    for number, name in enumerate(names, 1):
        failed = first_failure(removal, name)
        survived += failed is None
        print(f"{number:3}/{len(names)}  {'killed  ' if failed else 'SURVIVED'}  {name:30}  {failed or ''}", flush=True)
    print(f"{len(names) - survived} of {len(names)} {what} are missed by a test when they are taken out")
    return 1 if survived else 0

"""Each part of the code changed in turn: does a test notice? `make mutation`

A change is one comparison, constant, operator, condition, returned value, caught or raised exception, or a statement
left out (`operators.py`). Results are kept in a folder and published, however the run ends; what is published or kept
is not tried again: what was found, until its module changes, what survived, until a test does.
"""

import argparse
import math
import signal
import sys
import time
from collections.abc import Mapping
from contextlib import closing
from dataclasses import dataclass
from hashlib import sha256
from pathlib import Path
from typing import Any

from benchmarks.kept import keep_line, kept_lines, results_file, results_folder
from benchmarks.mutation import published
from benchmarks.mutation.forks import Status
from benchmarks.mutation.mutants import ROOT, Mutant, mutants_of
from benchmarks.mutation.packages import PACKAGES, Package, digest_of_module, digest_of_tests
from benchmarks.mutation.page import holds, page
from benchmarks.mutation.published import Result
from benchmarks.mutation.reach import reach_of
from benchmarks.mutation.scores import Score, score
from benchmarks.mutation.trials import tried

_TELL_EACH = 25
_PUBLISHED = ROOT / "docs" / "mutation.json"


@dataclass(frozen=True, slots=True)
class _Known:
    """Of one package: its mutants, and what became of those that were tried."""

    package: Package
    tests: str
    mutants: list[Mutant]
    results: dict[str, Result]


def _known(package: Package, folder: Path, packages: published.Packages) -> _Known:
    """What is published, and what is kept since: the newest of each mutant whose module is the same still."""
    mutants = [mutant for module in package.modules for mutant in mutants_of(module)]
    codes = {module: digest_of_module(module) for module in package.modules}
    kept = {
        line["mutant"]: Result(Status(line["status"]), line["tests"])
        for line in kept_lines(_file(package, folder))
        if codes.get(line["module"]) == line["code"]
    }
    results = published.results(packages.get(package.name, {}), mutants) | kept
    return _Known(package, digest_of_tests(package), mutants, results)


def _file(package: Package, folder: Path) -> Path:
    return folder / f"{package.name}.jsonl"


def _try_out(known: _Known, folder: Path, end_s: float) -> None:
    """Try what is left to try, until it is later than that on the monotonic clock."""
    settled = {key for key, result in known.results.items() if result.is_settled(known.tests)}
    left = sorted((mutant for mutant in known.mutants if mutant.key not in settled), key=_drawn)
    print(f"{known.package.name}: {len(known.mutants)} mutants, {len(left)} to try", flush=True)
    if left and time.monotonic() < end_s:
        _try_left(known, left, folder, end_s)


def _drawn(mutant: Mutant) -> str:
    """The order in which mutants are tried: any part of them is a fair sample of all."""
    return sha256(mutant.key.encode()).hexdigest()


def _try_left(known: _Known, left: list[Mutant], folder: Path, end_s: float) -> None:
    reach = reach_of(known.package, folder, known.tests)
    with closing(tried(known.package, left, reach)) as trials:
        for number, (mutant, outcome) in enumerate(trials, 1):
            known.results[mutant.key] = Result(outcome.status, known.tests)
            line: dict[str, Any] = {"mutant": mutant.key, "module": mutant.module, "status": outcome.status}
            line |= {"by": outcome.by, "code": digest_of_module(mutant.module), "tests": known.tests}
            keep_line(_file(known.package, folder), line)
            if number % _TELL_EACH == 0 or outcome.status in (Status.SURVIVED, Status.UNREACHED):
                print(f"{number:5}/{len(left)}  {outcome.status:9}  {_named(mutant)}", flush=True)
            if time.monotonic() > end_s:
                return


def _named(mutant: Mutant) -> str:
    """On one line, as an editor finds it."""
    return f"{mutant.place}:{mutant.lines[0]}  {mutant.before}  =>  {mutant.after}"


def _score(known: _Known) -> Score:
    name, found = known.package.name, score(known.mutants, _statuses(known.results))
    print(f"\n{name}: {len(found.missed)} changes that no test notices")
    for mutant in found.missed:
        print(f"  {_named(mutant)}")
    print(
        f"{name}: {found.found} of {found.found + len(found.missed) + found.left} found, at least "
        f"{100.0 * found.share:.1f} %; {found.tried} tried, {found.left} left, "
        f"{found.stillborn} that Python does not load, {found.equivalent} that mean the same"
    )
    return found


def _statuses(results: Mapping[str, Result]) -> dict[str, Status]:
    return {key: result.status for key, result in results.items()}


def _run(arguments: argparse.Namespace) -> int:
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("asked to end"))
    end_s = time.monotonic() + 60.0 * arguments.minutes
    packages = published.read(arguments.published)
    known = [_known(PACKAGES[name], arguments.folder, packages) for name in arguments.packages]
    try:
        for one in known:
            _try_out(one, arguments.folder, end_s)
    finally:
        packages |= {one.package.name: published.lines(one.results, one.mutants, one.tests) for one in known}
        published.write(arguments.published, packages)
    rows = [(one.package, _score(one)) for one in known]
    if arguments.page:
        arguments.page.write_text(page(rows))
    return 0 if all(holds(found) for _, found in rows) else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--packages", nargs="*", choices=sorted(PACKAGES), default=list(PACKAGES))
    parser.add_argument("--folder", type=results_folder, required=True, help="where the results are kept")
    parser.add_argument("--minutes", type=float, default=math.inf, help="after which none is begun; 0: try nothing")
    parser.add_argument(
        "--published", type=results_file, default=_PUBLISHED, help="results so far (default docs/mutation.json)"
    )
    parser.add_argument("--page", type=results_file, help="the page to write from them")
    sys.exit(_run(parser.parse_args()))

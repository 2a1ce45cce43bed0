"""Each part of the code changed in turn: does a test notice? `make mutation`

A change is one comparison, constant, operator, condition, returned value, caught or raised exception, or a statement
left out (`operators.py`). Results are kept in a folder; what was found is tried again when its module changes, what
survived when a test does.
"""

import argparse
import sys
from hashlib import sha256
from pathlib import Path
from typing import Any

from benchmarks.kept import keep_line, kept_lines
from benchmarks.mutation.forks import Status
from benchmarks.mutation.mutants import Mutant, mutants_of
from benchmarks.mutation.packages import PACKAGES, Package, digest_of_module, digest_of_tests
from benchmarks.mutation.page import holds, page
from benchmarks.mutation.reach import reach_of
from benchmarks.mutation.scores import Score, score
from benchmarks.mutation.trials import tried

_TELL_EACH = 25
_FINAL = (Status.KILLED, Status.ENDLESS, Status.STILLBORN)


def _kept(package: Package, path: Path) -> dict[str, dict[str, Any]]:
    """The newest result of each mutant whose module is the same still."""
    codes = {module: digest_of_module(module) for module in package.modules}
    return {line["mutant"]: line for line in kept_lines(path) if codes.get(line["module"]) == line["code"]}


def _is_settled(line: dict[str, Any] | None, tests: str) -> bool:
    """What no test noticed may be noticed once a test is another."""
    return line is not None and (line["status"] in _FINAL or line["tests"] == tests)


def _try_out(package: Package, folder: Path, kept_only: bool) -> list[Mutant]:
    """Try what is left to try; every mutant of the package."""
    mutants = [mutant for module in package.modules for mutant in mutants_of(module)]
    path = folder / f"{package.name}.jsonl"
    kept, tests = _kept(package, path), digest_of_tests(package)
    left = sorted((mutant for mutant in mutants if not _is_settled(kept.get(mutant.key), tests)), key=_drawn)
    print(f"{package.name}: {len(mutants)} mutants, {len(left)} to try", flush=True)
    if left and not kept_only:
        _try_left(package, left, folder, path)
    return mutants


def _drawn(mutant: Mutant) -> str:
    """The order in which mutants are tried: any part of them is a fair sample of all."""
    return sha256(mutant.key.encode()).hexdigest()


def _try_left(package: Package, left: list[Mutant], folder: Path, path: Path) -> None:
    tests = digest_of_tests(package)
    reach = reach_of(package, folder, tests)
    for number, (mutant, outcome) in enumerate(tried(package, left, reach), 1):
        line: dict[str, Any] = {"mutant": mutant.key, "module": mutant.module, "status": outcome.status}
        keep_line(path, line | {"by": outcome.by, "code": digest_of_module(mutant.module), "tests": tests})
        if number % _TELL_EACH == 0 or outcome.status not in _FINAL:
            print(f"{number:5}/{len(left)}  {outcome.status:9}  {_named(mutant)}", flush=True)


def _named(mutant: Mutant) -> str:
    """On one line, as an editor finds it."""
    return f"{mutant.place}:{mutant.lines[0]}  {mutant.before}  =>  {mutant.after}"


def _score(package: Package, mutants: list[Mutant], folder: Path) -> Score:
    kept = _kept(package, folder / f"{package.name}.jsonl")
    found = score(mutants, {key: Status(line["status"]) for key, line in kept.items()})
    print(f"\n{package.name}: {len(found.missed)} changes that no test notices")
    for mutant in found.missed:
        print(f"  {_named(mutant)}")
    print(
        f"{package.name}: {found.found} of {found.found + len(found.missed) + found.left} found, at least "
        f"{100.0 * found.share:.1f} %; {found.tried} tried, {found.left} left, "
        f"{found.stillborn} that Python does not load, {found.equivalent} that mean the same"
    )
    return found


def _run(arguments: argparse.Namespace) -> int:
    arguments.folder.mkdir(parents=True, exist_ok=True)
    packages = [PACKAGES[name] for name in arguments.packages]
    tried_out = [(package, _try_out(package, arguments.folder, arguments.kept_only)) for package in packages]
    rows = [(package, _score(package, mutants, arguments.folder)) for package, mutants in tried_out]
    if arguments.page:
        arguments.page.write_text(page(rows))
    return 0 if all(holds(found) for _, found in rows) else 1


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--packages", nargs="*", choices=sorted(PACKAGES), default=list(PACKAGES))
    parser.add_argument("--folder", type=Path, required=True, help="where the results are kept")
    parser.add_argument("--kept-only", action="store_true", help="try nothing, tell what is kept")
    parser.add_argument("--page", type=Path, help="the page to write from them")
    sys.exit(_run(parser.parse_args()))

"""Each interlock taken out in turn: does a test of the rules fail, and which one first?

`make interlock-removal`; exit status 1 where one is not missed by any test.
"""

import argparse
import os
import subprocess
import sys
from collections.abc import Sequence

from tests.workflow.without_interlock import VARIABLE
from workflow.interlocks import INTERLOCKS

# The search of every reachable case takes half a minute and proves less of a single interlock than these.
_TESTS = ("interlocks", "refusals", "observations", "permits", "overrides", "changed_configuration", "table")
# This one takes each interlock out by itself and fails for that reason alone where it is gone already.
_NOT_COUNTED = "not test_without_it_its_own_test_would_fail"
_FAILED = 1  # pytest's exit status where a test failed; 2 and above mean that it could not run


def first_failure(code: str) -> str | None:
    """The first test that fails without an interlock; None if none does."""
    files = (f"tests/workflow/test_{name}.py" for name in _TESTS)
    command = [sys.executable, "-m", "pytest", "-x", "-p", "tests.workflow.without_interlock", "-k", _NOT_COUNTED]
    environment = os.environ | {VARIABLE: code}
    run = subprocess.run([*command, "--tb=no", *files], env=environment, capture_output=True, text=True)
    if run.returncode == 0:
        return None
    if run.returncode != _FAILED:
        raise RuntimeError(run.stdout + run.stderr)
    failed = next(line for line in run.stdout.splitlines() if line.startswith("FAILED "))
    return failed.removeprefix("FAILED ").split(" - ")[0]


def main(codes: Sequence[str]) -> int:
    """Print a line for each interlock, then how many were missed."""
    survived = 0
    for number, code in enumerate(codes, 1):
        failed = first_failure(code)
        survived += failed is None
        print(f"{number:3}/{len(codes)}  {'killed  ' if failed else 'SURVIVED'}  {code:22}{failed or ''}", flush=True)
    print(f"{len(codes) - survived} of {len(codes)} interlocks are missed by a test when they are taken out")
    return 1 if survived else 0


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--interlocks", nargs="*", choices=sorted(INTERLOCKS), default=sorted(INTERLOCKS))
    sys.exit(main(parser.parse_args().interlocks))

"""Each interlock taken out in turn: does a test of the rules fail, and which one first? `make interlock-removal`"""

import argparse
import sys

from benchmarks.removal import Removal, take_out_each
from tests.workflow.without_interlock import VARIABLE
from workflow.interlocks import INTERLOCKS

# The search of every reachable case takes half a minute and proves less of a single interlock than these.
_TESTS = [
    "interlocks",
    "refusals",
    "observations",
    "permits",
    "overrides",
    "changed_configuration",
    "old_image",
    "table",
]
REMOVAL = Removal(
    plugin="tests.workflow.without_interlock",
    variable=VARIABLE,
    tests=tuple(f"tests/workflow/test_{name}.py" for name in _TESTS),
    not_counted="test_without_it_its_own_test_would_fail",
)

NAMES = sorted(INTERLOCKS)

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--interlocks", nargs="*", choices=NAMES, default=NAMES)
    sys.exit(take_out_each(REMOVAL, parser.parse_args().interlocks, "interlocks"))

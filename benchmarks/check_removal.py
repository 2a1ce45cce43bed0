"""Each check of the guard taken out in turn: does a test fail, and which one first? `make check-removal`"""

import argparse
import sys

from benchmarks.removal import Removal, take_out_each
from tests.robot.without_check import MODULES, VARIABLE, checks

# Without a controller and in no time of the clock's; what keeps real time would take an hour more.
_TESTS = ("motion_judge", "guard_starts", "guard_control", "guard_ends", "feedback", "heartbeat", "journal")
REMOVAL = Removal(
    plugin="tests.robot.without_check",
    variable=VARIABLE,
    tests=tuple(f"tests/robot/test_{name}.py" for name in _TESTS),
)

NAMES = [check for module in MODULES for check in checks(module)]

if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--checks", nargs="*", choices=NAMES, metavar="CHECK", default=NAMES)
    sys.exit(take_out_each(REMOVAL, parser.parse_args().checks, "checks of the guard"))

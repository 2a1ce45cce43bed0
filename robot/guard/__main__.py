"""`python -m robot.guard`: run by `GuardClient`."""

from argparse import ArgumentParser
from pathlib import Path

from robot.guard.process import run

_parser = ArgumentParser(prog="robot.guard", description=__doc__)
_parser.add_argument("--arm", required=True, help="IPv4 address of the controller")
_parser.add_argument("--journal", required=True, type=Path, help="folder of the journal")
_arguments = _parser.parse_args()
run(_arguments.arm, _arguments.journal)

"""A plugin of pytest that takes one check out of the guard: `-p tests.robot.without_check`.

A check is a condition under which the guard refuses a motion or ends one: `if ...: return Refusal(...)`, or an
`EndCause` in the place of the refusal. Taken out, its condition is never met.
"""

import ast
import importlib
import os
from collections.abc import Iterator
from pathlib import Path

import pytest

VARIABLE = "COAXIAL_TEST_WITHOUT_CHECK"
MODULES = ("robot.guard.admission", "robot.guard.guard", "robot.guard.motion", "robot.guard.preflight")
_CALM = ("EndCause.ARRIVED", "EndCause.MISSED")
_ROOT = Path(__file__).parents[2]


def checks(module: str) -> list[str]:
    """Every check of a module, as module:line."""
    return [f"{module}:{node.test.lineno}" for node in _conditions(_parsed(module))]


@pytest.hookimpl(tryfirst=True)
def pytest_load_initial_conftests() -> None:
    """Run the module once more as it would be without the check, before anything else has imported from it.

    What the tests share imports the guard, so that a later hook would take out nothing that they use.
    """
    module, _, line = os.environ[VARIABLE].partition(":")
    tree = _parsed(module)
    taken_out = [node for node in _conditions(tree) if node.test.lineno == int(line)]
    if not taken_out:
        raise pytest.UsageError(f"no check in {module} at line {line}")
    for node in taken_out:
        node.test = ast.copy_location(ast.Constant(False), node.test)
    loaded = importlib.import_module(module)
    exec(compile(tree, str(loaded.__file__), "exec"), loaded.__dict__)


def _parsed(module: str) -> ast.Module:
    return ast.parse((_ROOT / module.replace(".", "/")).with_suffix(".py").read_text())


def _conditions(tree: ast.Module) -> Iterator[ast.If | ast.IfExp]:
    nodes = (node for node in ast.walk(tree) if isinstance(node, ast.If | ast.IfExp))
    return (node for node in nodes if _says_no(_outcome(node)))


def _outcome(node: ast.If | ast.IfExp) -> ast.expr | None:
    """What is returned where the condition is met."""
    if isinstance(node, ast.IfExp):
        return node.body
    last = node.body[-1]
    return last.value if isinstance(last, ast.Return) else None


def _says_no(value: ast.expr | None) -> bool:
    """Whether it is a refusal, or the cause of an end that is none of the calm ones."""
    if value is None or isinstance(value, ast.IfExp):  # which is a check by itself
        return False
    told = ast.unparse(value)
    return told.startswith(("Refusal(", "EndCause.", "_SAFETY_CAUSES[")) and told not in _CALM

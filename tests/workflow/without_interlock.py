"""A plugin of pytest that takes one interlock out of the rules: `-p tests.workflow.without_interlock`.

The interlock's code comes in the environment, since the plugin is loaded before any option is read.
"""

import os

import pytest

from workflow import interlocks
from workflow.checks import Interlock
from workflow.inquiry import Inquiry

VARIABLE = "COAXIAL_TEST_WITHOUT_INTERLOCK"


def pytest_configure(config: pytest.Config) -> None:
    """Everything is judged as ever, but by one interlock fewer."""
    code, required = os.environ[VARIABLE], interlocks.required
    if code not in interlocks.INTERLOCKS:
        raise pytest.UsageError(f"no interlock {code}")

    def without(inquiry: Inquiry) -> tuple[Interlock, ...]:
        return tuple(lock for lock in required(inquiry) if lock.code != code)

    interlocks.required = without

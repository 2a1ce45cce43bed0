"""The page of the state machine is the one that the table generates."""

import subprocess
import sys
from pathlib import Path

from workflow.diagram import mermaid, page
from workflow.interlocks import INTERLOCKS
from workflow.states import State
from workflow.triggers import Trigger

PAGE = Path(__file__).parents[2] / "docs" / "state-machine.md"


def test_the_committed_page_is_generated_from_the_table():
    assert PAGE.read_text() == page(), "write it anew: python -m workflow.diagram > docs/state-machine.md"


def test_the_command_prints_the_page():
    printed = subprocess.run([sys.executable, "-m", "workflow.diagram"], check=True, capture_output=True, text=True)
    assert printed.stdout == page()


def test_every_state_is_drawn_and_every_trigger_and_interlock_listed():
    assert all(f" {state}" in mermaid() for state in State)
    assert all(f"`{trigger}`" in page() for trigger in Trigger)
    assert all(f"`{code}`" in page() for code in INTERLOCKS)

"""The README shows what the code is: its picture of the state machine, and the codes it points to."""

from pathlib import Path

from workflow.diagram import mermaid

README = Path(__file__).parent.parent / "README.md"


def test_the_readme_shows_the_picture_of_the_table_as_it_is() -> None:
    shown = README.read_text().split("<!-- state-machine:begin -->")[1].split("<!-- state-machine:end -->")[0]
    assert shown.strip() == f"```mermaid\n{mermaid().strip()}\n```", "run `make docs`"


def test_the_readme_says_what_the_software_is_not_for() -> None:
    assert "Not for clinical use" in README.read_text()

"""Results kept line by line, so that a run goes on where the last one ended."""

import json
from pathlib import Path
from typing import Any


def kept_lines(path: Path) -> list[dict[str, Any]]:
    """Results of earlier runs; a last line that was cut off is taken out of the file."""
    if not path.exists():
        return []
    text = path.read_text()
    whole = text[: text.rfind("\n") + 1]
    if whole != text:
        path.write_text(whole)
    return [json.loads(line) for line in whole.splitlines()]


def keep_line(path: Path, fields: dict[str, Any]) -> None:
    """Add one result."""
    with path.open("a") as file:
        file.write(json.dumps(fields) + "\n")

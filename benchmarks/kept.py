"""Results kept line by line, so that a run goes on where the last one ended."""

import json
from argparse import ArgumentTypeError
from pathlib import Path
from typing import Any


def results_folder(name: str) -> Path:
    """A folder named at the command line, made where missing; ArgumentTypeError, which is wrong usage, elsewhere."""
    try:
        Path(name).mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ArgumentTypeError(f"{name}: {error.strerror}") from error
    return Path(name)


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

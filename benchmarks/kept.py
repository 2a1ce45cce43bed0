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


def results_file(name: str) -> Path:
    """A file that can be written at the end of a run, of hours perhaps; ArgumentTypeError elsewhere."""
    if Path(name).is_dir() or not Path(name).absolute().parent.is_dir():
        raise ArgumentTypeError(f"{name}: no file can be there")
    return Path(name)


def at_least_one(text: str) -> int:
    """A number of things to do; ArgumentTypeError where that is none, which would pass for a measurement."""
    if not text.isdecimal() or int(text) < 1:
        raise ArgumentTypeError(f"{text} is no whole number from 1")
    return int(text)


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

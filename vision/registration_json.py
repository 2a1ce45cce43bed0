"""A registration as JSON, exactly as the command-line contract prints it, and back."""

from typing import Any

from vision.registered import Registration


def to_json(registration: Registration, path: str | None = None) -> dict[str, Any]:
    """The JSON object of `coaxial register`; `path` is where the image came from, if from a file."""
    raise NotImplementedError


def from_json(data: Any) -> Registration:
    """The registration in a JSON object; unknown keys are ignored.

    Raises
    ------
    ValueError
        One line naming what is missing or implausible.
    """
    raise NotImplementedError

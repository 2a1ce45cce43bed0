"""Commands whose help and errors are plain lines: no boxes, which a pipe breaks, and scripts expect one clear line."""

from typing import Any

import typer


def plain_typer(**more: Any) -> typer.Typer:
    """A command or a group of them; `more` as `typer.Typer` takes it."""
    return typer.Typer(add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None, **more)

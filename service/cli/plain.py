"""Commands whose help and errors are plain lines: no boxes, which a pipe breaks, and scripts expect one clear line."""

from typing import Any

import typer
from typer.core import TyperGroup

_WHOLE = 1000  # characters, more than a first sentence has


class PlainGroup(TyperGroup):
    """A group whose help tells the first sentence about each command whole; usually it is cut off at the line's end."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """A line or more for each command."""
        commands = ((name, self.get_command(ctx, name)) for name in self.list_commands(ctx))
        rows = [(name, command.get_short_help_str(_WHOLE)) for name, command in commands if command is not None]
        with formatter.section("Commands"):
            formatter.write_dl(rows)


def plain_typer(cls: type[PlainGroup] = PlainGroup, **more: Any) -> typer.Typer:
    """A command or a group of them; `more` as `typer.Typer` takes it."""
    return typer.Typer(cls=cls, add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None, **more)

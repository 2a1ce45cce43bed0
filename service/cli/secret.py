"""Where a command has a password or a PIN from: never an argument, which every user of the machine sees."""

import os
import sys

import typer

_UNUSABLE = 2


def secret(variable: str, prompt: str, *, twice: bool = False) -> str:
    """From the environment, else a line of stdin, else asked for at the terminal; ends the command where none comes."""
    if variable in os.environ:
        return os.environ[variable]
    given = _asked(prompt, twice=twice) if sys.stdin is not None and sys.stdin.isatty() else _line()
    if not given:
        typer.echo(
            f"error: no {prompt} was given: at a terminal, as a line of standard input, or as {variable}", err=True
        )
        raise typer.Exit(_UNUSABLE)
    return given


def _asked(prompt: str, *, twice: bool) -> str:
    """Empty where the question was not answered: Ctrl-C, Ctrl-D."""
    try:
        return str(typer.prompt(prompt, hide_input=True, confirmation_prompt=twice))
    except typer.Abort:
        return ""


def _line() -> str:
    return "" if sys.stdin is None else sys.stdin.readline().rstrip("\n")

"""Where the output of a command goes may be full, closed early, or know no such letters."""

import os
import subprocess
import sys
from pathlib import Path
from subprocess import PIPE, CompletedProcess
from typing import Any

import pytest

_COAXIAL = str(Path(sys.executable).with_name("coaxial"))
_DEVICES = Path(__file__).parents[1] / "devices"
_PLAN = ("plan-carm", "--entry", "32,85,12", "--target", "20,40,4")
_BUDGET = ("budget", "--guide", str(_DEVICES / "guide.toml"), "--carm", str(_DEVICES / "flat-panel.toml"))


def run(*arguments: str | Path, env: dict[str, str] | None = None, **more: Any) -> CompletedProcess[bytes]:
    """The installed command in a process of its own."""
    environment = os.environ | (env or {})
    return subprocess.run([_COAXIAL, *map(str, arguments)], **more, env=environment, timeout=60)


@pytest.mark.parametrize("arguments", [_PLAN, _BUDGET, ("--help",)])
def test_a_full_disk_under_the_output_is_told_in_one_line(arguments: tuple[str, ...]) -> None:
    with Path("/dev/full").open("wb") as full:
        done = run(*arguments, stdout=full, stderr=PIPE)
    assert done.stderr.decode() == "error: what is printed is cut off: No space left on device\n"
    assert done.returncode == 2


def test_a_full_disk_under_output_and_complaints_is_an_exit_status() -> None:
    with Path("/dev/full").open("wb") as full:
        assert run(*_PLAN, stdout=full, stderr=full).returncode == 2


def test_nobody_reading_on_ends_a_command_without_a_word() -> None:
    reader, writer = os.pipe()
    os.close(reader)
    done = run(*_PLAN, stdout=writer, stderr=PIPE)
    os.close(writer)
    assert (done.returncode, done.stderr) == (1, b"")


def test_a_name_that_the_terminal_has_no_letters_for_is_spelt_out(tmp_path: Path) -> None:
    at = ("--data-folder", tmp_path / "site")
    assert run("db", "upgrade", *at, stdout=PIPE, stderr=PIPE).returncode == 0
    env, file = {"PYTHONIOENCODING": "latin-1"}, tmp_path / "Łukasz.db"
    done = run("db", "backup", file, *at, stdout=PIPE, stderr=PIPE, env=env)
    assert (done.returncode, done.stdout) == (0, f"backed up to {tmp_path}/\\u0141ukasz.db\n".encode())
    assert file.exists()

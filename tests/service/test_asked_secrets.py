"""A password is asked for at a terminal; a question that is not answered ends the command and changes nothing."""

import os
import pty
import signal
import sys
from pathlib import Path

import pytest

_COAXIAL = str(Path(sys.executable).with_name("coaxial"))
# The space comes once the terminal echoes no more; what is typed before is thrown away.
_PASSWORD, _PIN, _AGAIN = b"Password: ", b"PIN: ", b"Repeat for confirmation: "


def at_a_terminal(keys: list[tuple[bytes, bytes]], *arguments: str | Path) -> tuple[int, str]:
    """The exit status and what was shown; each time a text has come the keys behind it are pressed."""
    child, terminal = pty.fork()
    if child == 0:
        signal.signal(signal.SIGINT, signal.SIG_DFL)  # whoever starts the tests in the background ignores it
        environment = {name: value for name, value in os.environ.items() if not name.startswith("COAXIAL_")}
        os.execve(_COAXIAL, [_COAXIAL, *map(str, arguments)], environment)
    shown, seen, awaited = b"", 0, list(keys)
    while True:
        try:
            shown += os.read(terminal, 1000)
        except OSError:  # the other end is closed
            break
        if awaited and awaited[0][0] in shown[seen:]:
            seen = len(shown)
            os.write(terminal, awaited.pop(0)[1])
    _, status = os.waitpid(child, 0)
    os.close(terminal)
    return os.waitstatus_to_exitcode(status), shown.decode().replace("\r\n", "\n")


@pytest.mark.parametrize("key", [b"\x03", b"\x04"], ids=["ctrl-c", "ctrl-d"])
def test_a_question_that_is_not_answered_ends_with_one_line_and_status_2(tmp_path: Path, key: bytes) -> None:
    folder = tmp_path / "site"
    add = ("user", "add", "anna", "--role", "surgeon", "--data-folder", folder)
    status, shown = at_a_terminal([(_PASSWORD, key)], *add)
    assert status == 2
    assert "error: no Password was given: at a terminal, as a line of standard input, or as COAXIAL_PASSWORD" in shown
    assert "Traceback" not in shown
    assert not folder.exists()


def test_what_is_typed_twice_at_a_terminal_is_taken_and_never_shown(tmp_path: Path) -> None:
    typed = [(_PASSWORD, b"correct horse\n"), (_AGAIN, b"correct horse\n"), (_PIN, b"2468\n"), (_AGAIN, b"2468\n")]
    add = ("user", "add", "anna", "--role", "surgeon", "--data-folder", tmp_path / "site")
    status, shown = at_a_terminal(typed, *add)
    assert (status, shown.splitlines()[-1]) == (0, "added anna as surgeon")
    assert "correct" not in shown
    assert "2468" not in shown

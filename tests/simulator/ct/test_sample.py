"""The command that writes a CT to try the room with."""

import subprocess
import sys
from pathlib import Path


def _sample(*arguments: str, folder: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "simulator.ct.sample", *arguments]
    return subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=60)


def test_a_folder_that_cannot_be_made_is_wrong_usage(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    done = _sample("file", folder=tmp_path)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.splitlines()[-1].endswith("error: file: File exists")
    assert "Traceback" not in done.stderr


def test_a_question_for_help_makes_no_folder(tmp_path: Path) -> None:
    assert _sample("--help", folder=tmp_path).returncode == 0
    assert list(tmp_path.iterdir()) == []

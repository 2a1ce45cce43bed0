"""Where a measurement keeps its results is looked at before anything is measured."""

import subprocess
import sys
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "command",
    [
        ["-m", "benchmarks.faulted"],
        ["-m", "benchmarks.mutation"],
        ["-m", "benchmarks.coverage"],
        ["benchmarks/coverage.py"],
        ["benchmarks/service_latency.py"],
    ],
    ids=" ".join,
)
def test_a_file_in_the_folder_s_place_is_wrong_usage(command: list[str], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    done = subprocess.run(
        [sys.executable, *command, "--folder", tmp_path / "file"], cwd=_ROOT, capture_output=True, text=True, timeout=60
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr.splitlines()[-1].endswith(f"error: argument --folder: {tmp_path / 'file'}: File exists")
    assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("command", "said"),
    [
        (["benchmarks.replay", "--cases", "0"], "argument --cases: 0 is no whole number from 1"),
        (["benchmarks.trends", "--reports", "none"], "argument --reports: none is no whole number from 1"),
        (["benchmarks.mutation", "--folder", "{}", "--page", "{}"], "argument --page: {}: no file can be there"),
        (["benchmarks.mutation", "--folder", "{}", "--published", "{}/a/b"], "{}/a/b: no file can be there"),
        (
            ["benchmarks.check_removal", "--checks", "robot.guard:0"],
            "argument --checks: invalid choice: 'robot.guard:0'",
        ),
    ],
)
def test_what_would_end_a_run_late_or_in_nothing_is_wrong_usage(command: list[str], said: str, tmp_path: Path) -> None:
    words = [word.format(tmp_path) for word in command]
    done = subprocess.run([sys.executable, "-m", *words], cwd=_ROOT, capture_output=True, text=True, timeout=60)
    assert (done.returncode, done.stdout) == (2, "")
    assert said.format(tmp_path) in done.stderr.splitlines()[-1]

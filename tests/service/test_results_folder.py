"""Where a measurement keeps its results is looked at before anything is measured."""

import subprocess
import sys
from pathlib import Path

import pytest

_ROOT = Path(__file__).parents[2]


@pytest.mark.parametrize(
    "command",
    [
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

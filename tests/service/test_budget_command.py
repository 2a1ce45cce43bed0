import json
import math
from pathlib import Path

import cv2
import numpy as np
import pytest
from typer.testing import CliRunner, Result

from service.cli.main import app

_DEVICES = Path(__file__).parents[1] / "devices"
SOURCES = {
    "pixel noise",
    "distortion",
    "intrinsics",
    "ring tolerances",
    "bore",
    "TCP calibration",
    "arm",
    "target depth",
}


def run(*more: str | Path) -> Result:
    """`coaxial budget` for the reference devices."""
    devices = ("--guide", _DEVICES / "guide.toml", "--carm", _DEVICES / "flat-panel.toml")
    return CliRunner().invoke(app, ["budget", *map(str, (*devices, *more))])


def test_the_table_names_every_source_and_the_total() -> None:
    result = run()
    assert result.exit_code == 0, result.output
    for name in SOURCES | {"total"}:
        assert name in result.stdout
    assert "drawn" not in result.stdout


def test_as_json_the_shares_make_up_the_whole_and_the_check_is_told() -> None:
    result = run("--json", "--check", "50")
    assert result.exit_code == 0, result.output
    printed = json.loads(result.stdout)
    assert set(printed["sources"]) == SOURCES
    assert math.fsum(one["angle_share"] for one in printed["sources"].values()) == pytest.approx(1.0)
    assert printed["total"]["position_95_mm"] > printed["sources"]["arm"]["position_95_mm"]
    assert printed["check"]["draws"] == 50
    assert set(printed["check"]["sources"]) == SOURCES - {"target depth"}
    assert printed["check"]["sources"]["distortion"] == {"angle": None, "position": None}  # of a flat panel


def test_the_plot_is_a_picture(tmp_path: Path) -> None:
    assert run("--out", tmp_path / "plots", "--check", "5").exit_code == 0
    picture = cv2.imdecode(np.fromfile(tmp_path / "plots" / "budget.png", np.uint8), cv2.IMREAD_COLOR)
    assert picture.shape[1] == 1500


def test_a_better_arm_leaves_less() -> None:
    both = [json.loads(run("--json", "--arm-sd-mm", sd).stdout)["total"]["position_95_mm"] for sd in ("0.1", "0.02")]
    assert both[1] < 0.7 * both[0]


def test_the_calibration_s_own_file_says_how_well_it_is_known(device_files: dict[str, str], tmp_path: Path) -> None:
    (tmp_path / "tcp.toml").write_text(device_files["tcp"] + "\n[calibration]\nrotation_sd_deg = 0.5\n")
    angles = [
        json.loads(run("--json", *more).stdout)["sources"]["TCP calibration"]["angle_95_deg"]
        for more in ((), ("--tcp", tmp_path / "tcp.toml"))
    ]
    assert angles[1] == pytest.approx(10.0 * angles[0], rel=0.01)


def test_a_depth_that_reaches_the_source_is_a_wrong_option() -> None:
    result = run("--depth-mm", "700")
    assert result.exit_code == 2
    assert "implausible" in result.stderr

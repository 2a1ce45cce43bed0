"""`coaxial calibrate-tcp` on rendered images: a planted error is found and written down, what is unfit is refused."""

import json
from datetime import date
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from typer.testing import CliRunner, Result

from robot.tool import read_tool
from service.cli.calibration import calibrate_tcp
from simulator.carm.camera import Camera
from simulator.carm.guide import GuideShape
from simulator.carm.render import render
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from vision.devices import read_carm, read_guide
from vision.refusal import Refusal
from vision.registration import register
from vision.sightings import sightings
from vision.xray import decode

_DEVICES = Path(__file__).parents[1] / "devices"
IMAGES = 12
# Every registration leans on a C-arm file that is 10 mm off; the arm's motion must settle that.
CAMERA = Camera(source_to_image_mm=1010.0, pixel_mm=360.0 / 1024, principal_u_px=516.0, principal_v_px=507.0)


def pose(turn_deg: list[float], shift_mm: list[float]) -> np.ndarray:
    transform = np.eye(4)
    transform[:3, :3] = Rotation.from_rotvec(turn_deg, degrees=True).as_matrix()
    transform[:3, 3] = shift_mm
    return transform


PLANTED = pose([0.2, -0.2, 0.1], [0.3, -0.3, 0.26])  # 0.5 mm, 0.3 deg
SOURCE_FROM_BASE = pose([175.0, 10.0, -5.0], [120.0, -300.0, 700.0])
VIEWS = [
    pose([25.0, 0.0, 40.0], [30.0, -20.0, 720.0]),
    pose([-20.0, 18.0, -35.0], [-30.0, 25.0, 780.0]),
    pose([5.0, -28.0, 10.0], [25.0, 30.0, 750.0]),
    pose([0.0, 27.0, 60.0], [-25.0, -30.0, 740.0]),
    pose([-26.0, -10.0, -60.0], [0.0, 0.0, 800.0]),
    pose([15.0, 20.0, 0.0], [20.0, 10.0, 700.0]),
    pose([-12.0, 24.0, 80.0], [-15.0, -20.0, 770.0]),
    pose([22.0, -14.0, -80.0], [-20.0, 20.0, 730.0]),
    pose([-24.0, 6.0, 25.0], [15.0, 15.0, 760.0]),
    pose([8.0, 26.0, -50.0], [-10.0, 30.0, 710.0]),
    pose([20.0, -20.0, 70.0], [30.0, 0.0, 790.0]),
    pose([-18.0, -20.0, -20.0], [-30.0, -10.0, 720.0]),
]


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory, device_files: dict[str, str]) -> Path:
    """A folder with device files, images and POSES.jsonl, as the room would leave it."""
    folder = tmp_path_factory.mktemp("poses")
    for kind, content in device_files.items():
        (folder / f"{kind}.toml").write_text(content)
    tool = read_tool(device_files["tcp"].encode())
    lines = []
    for number, view in enumerate(VIEWS):
        scene = Scene(
            CAMERA, (PlacedGuide(GuideShape(), view),), (500.0, 500.0), intensifier=False, exposure=Exposure(bits=16)
        )
        cv2.imwrite(str(folder / f"{number}.png"), render(scene, number).pixels)
        base_from_flange = np.linalg.inv(SOURCE_FROM_BASE) @ view @ np.linalg.inv(tool.flange_from_guide @ PLANTED)
        told = base_from_flange @ tool.flange_from_guide
        lines.append(json.dumps({"image": f"{number}.png", "base_from_tcp": told.tolist()}))
    (folder / "poses.jsonl").write_text("\n".join(lines) + "\n")
    return folder


def run(folder: Path, poses: str = "poses.jsonl", expires: str = "2999-01-31") -> Result:
    devices = [word for kind in ("guide", "carm") for word in (f"--{kind}", str(folder / f"{kind}.toml"))]
    rest = ["--tool", str(folder / "tcp.toml"), "--version", "2", "--expires", expires]
    return CliRunner().invoke(calibrate_tcp, [str(folder / poses), *devices, *rest, "--out", str(folder / "new.toml")])


def test_planted_error_is_found_and_the_new_file_holds_it_with_an_expiry_and_all_else_as_it_was(recorded: Path) -> None:
    done = run(recorded)
    assert done.exit_code == 0, done.output
    told = json.loads(done.stdout)
    before, after = (read_tool((recorded / name).read_bytes()) for name in ("tcp.toml", "new.toml"))
    apart = np.linalg.inv(after.flange_from_guide) @ before.flange_from_guide @ PLANTED
    assert np.linalg.norm(apart[:3, 3]) < 0.05  # mm
    assert np.rad2deg(Rotation.from_matrix(apart[:3, :3]).magnitude()) < 0.03
    assert told["changed_mm"] == pytest.approx(0.5, abs=0.05)
    assert told["translation_sd_mm"] < 0.3
    assert len(told["residuals_mm"]) == IMAGES
    assert (after.name, after.version, after.expires) == (before.name, "2", date(2999, 1, 31))
    assert after.payload_kg == before.payload_kg
    assert after.tcp_tolerance_rad == pytest.approx(before.tcp_tolerance_rad, rel=1e-9)
    assert after.envelope.below_mm == before.envelope.below_mm


def test_too_few_poses_are_refused_and_nothing_is_written(recorded: Path) -> None:
    (recorded / "few.jsonl").write_text("\n".join((recorded / "poses.jsonl").read_text().splitlines()[:1]))
    (recorded / "new.toml").unlink(missing_ok=True)
    refused = run(recorded, "few.jsonl")
    assert refused.exit_code == 3
    told = json.loads(refused.stdout)
    assert (told["code"], told["measured"], told["limit"]) == ("too_few_poses", 1.0, 6.0)
    assert not (recorded / "new.toml").exists()


def rewritten(folder: Path, name: str, lines: list[dict[str, Any]]) -> str:
    (folder / "new.toml").unlink(missing_ok=True)
    (folder / name).write_text("\n".join(json.dumps(line) for line in lines))
    return name


def told_poses(folder: Path) -> list[dict[str, Any]]:
    return [json.loads(line) for line in (folder / "poses.jsonl").read_text().splitlines()]


@pytest.mark.hazard("H12")
def test_poses_of_a_controller_with_another_tcp_are_refused_though_all_fit_together(recorded: Path) -> None:
    lines = told_poses(recorded)
    for line in lines:  # its TCP stood 30 mm farther along the flange's z than that of the file
        line["base_from_tcp"] = (np.array(line["base_from_tcp"]) @ pose([0, 0, 0], [0.0, 0.0, 30.0])).tolist()
    refused = run(recorded, rewritten(recorded, "other.jsonl", lines))
    assert refused.exit_code == 3, refused.output
    told = json.loads(refused.stdout)
    assert (told["code"], told["limit"]) == ("tcp_mismatch", 10.0)
    assert told["measured"] == pytest.approx(30.0, abs=1.0)
    assert "name the file whose TCP the controller had" in told["message"]
    assert not (recorded / "new.toml").exists()


@pytest.mark.hazard("H09")
def test_a_pose_in_metres_is_no_pose_and_its_line_is_named(recorded: Path) -> None:
    lines = told_poses(recorded)
    in_metres = np.array(lines[2]["base_from_tcp"])
    in_metres[:3, 3] /= 1000.0
    lines[2]["base_from_tcp"] = in_metres.tolist()
    refused = run(recorded, rewritten(recorded, "metres.jsonl", lines))
    assert refused.exit_code == 2
    assert "line 3 " in refused.stderr
    assert "write it in mm" in refused.stderr


def test_an_image_again_under_another_name_is_no_further_witness(recorded: Path) -> None:
    lines = told_poses(recorded)
    (recorded / "again.png").write_bytes((recorded / "0.png").read_bytes())
    lines.insert(1, lines[0] | {"image": "again.png"})
    refused = run(recorded, rewritten(recorded, "again.jsonl", lines))
    assert refused.exit_code == 2
    assert "again.png is the image 0.png again" in refused.stderr
    assert not (recorded / "new.toml").exists()


def test_a_last_day_that_is_past_is_refused_before_the_images_are_looked_at(recorded: Path) -> None:
    (recorded / "new.toml").unlink(missing_ok=True)
    refused = run(recorded, expires="2026-01-31")
    assert refused.exit_code == 2
    assert "2026-01-31 is past" in refused.stderr
    assert not (recorded / "new.toml").exists()


@pytest.mark.parametrize(
    "content", ["{", '{"image": "0.png"}', '{"image": "0.png", "base_from_tcp": [[1.0]]}', '["0.png"]', "\x00"]
)
def test_poses_that_are_none_end_the_command_with_one_line(recorded: Path, content: str) -> None:
    (recorded / "broken.jsonl").write_text(content)
    broken = run(recorded, "broken.jsonl")
    assert broken.exit_code == 2
    assert broken.stdout == ""
    assert len(broken.stderr.strip().splitlines()) == 1


def test_one_image_and_the_files_share_together_are_the_registration(recorded: Path) -> None:
    image = decode((recorded / "0.png").read_bytes())
    assert not isinstance(image, Refusal)
    guide, carm = read_guide((recorded / "guide.toml").read_bytes()), read_carm((recorded / "carm.toml").read_bytes())
    registration = register(image, guide, carm)
    assert not isinstance(registration, Refusal)
    [one], prior = sightings([registration])
    # both costs as functions of the error d of shared quantities and pose: their minimum is where the fit ended
    rows = np.vstack([one.weights, np.hstack([prior.weights, np.zeros((len(prior.weights), 6))])])
    wanted = np.concatenate([one.offset, prior.weights @ (prior.values - one.shared)])
    step, *_ = np.linalg.lstsq(rows, wanted)
    sd = np.sqrt(np.diag(np.linalg.inv(rows.T @ rows)))
    assert np.abs(step / sd).max() < 0.05
    ten = [0, 1, 2, 3, 7, 8, 9, 10, 11, 12]  # without the dimensions
    assert sd[ten] == pytest.approx(np.sqrt(np.diag(registration.covariance)), rel=0.01)

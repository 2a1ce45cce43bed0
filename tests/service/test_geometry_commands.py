import json
import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from typer.testing import CliRunner, Result

from service.cli.main import app
from service.cores import cores
from service.version import PRODUCT_VERSION

_COAXIAL = str(Path(sys.executable).with_name("coaxial"))
# To the superuser no file is closed.
_WITHOUT_RIGHTS = () if os.geteuid() else ("setpriv", "--bounding-set=-dac_override,-dac_read_search")
_DEVICES = Path(__file__).parents[1] / "devices"
GUIDE_TOML = (_DEVICES / "guide.toml").read_text()

CARM_TOML = (_DEVICES / "flat-panel.toml").read_text()

SIDE_PX = 1024
ALPHA_PX = 1000.0 / 360.0 * SIDE_PX
CENTRE_PX = (SIDE_PX - 1) / 2.0


def pose(tilt_deg: float = 10.0, roll_deg: float = 25.0) -> np.ndarray:
    """The guide's pose in the drawn image, (4, 4), mm."""
    source_from_guide = np.eye(4)
    turn = Rotation.from_euler("x", tilt_deg, degrees=True) * Rotation.from_euler("z", roll_deg, degrees=True)
    source_from_guide[:3, :3] = turn.as_matrix()
    source_from_guide[:3, 3] = (10.0, -5.0, 750.0)
    return source_from_guide


def drawn(source_from_guide: np.ndarray) -> np.ndarray:
    """A plain X-ray of the guide, 16 bits, drawn by OpenCV: no plate, no anatomy, little noise."""
    around = np.linspace(0.0, 2.0 * np.pi, 1000)
    circle = np.column_stack((np.cos(around), np.sin(around), np.zeros_like(around)))
    wires = [
        circle * 20.0,
        circle * 30.0 - (0.0, 0.0, 60.0),
        # OpenCV rounds a line's ends off beyond them by half its width, here 0.58 mm
        np.column_stack((np.linspace(26.58, 65.42, 200), np.zeros(200), np.zeros(200))),
    ]
    scale = 4  # drawn larger and averaged down, so that the wires' edges lie between pixels
    canvas = np.zeros((SIDE_PX * scale, SIDE_PX * scale), np.float32)
    for wire in wires:
        layer = np.zeros_like(canvas)
        cv2.polylines(layer, [on_canvas(wire, source_from_guide, scale)], False, 1.0, round(4.4 * scale), shift=4)
        canvas += layer
    bead = np.zeros_like(canvas)
    (centre,) = on_canvas(np.array([[0.0, 45.0, -30.0]]), source_from_guide, scale)
    cv2.circle(bead, [int(value) for value in centre], round(5.7 * scale * 16), 1.5, -1, shift=4)
    density = cv2.resize(canvas + bead, (SIDE_PX, SIDE_PX), interpolation=cv2.INTER_AREA)
    density = cv2.GaussianBlur(density, (0, 0), 1.0)
    noise = np.random.default_rng(1).normal(0.0, 150.0, density.shape)
    return np.clip(45_000.0 * np.exp(-0.6 * density) + noise, 0, 65_535).astype(np.uint16)


def on_canvas(points: np.ndarray, source_from_guide: np.ndarray, scale: int) -> np.ndarray:
    """Projected points in OpenCV's sixteenths of the enlarged canvas."""
    in_source = points @ source_from_guide[:3, :3].T + source_from_guide[:3, 3]
    pixels = in_source[:, :2] / in_source[:, 2:] * ALPHA_PX + CENTRE_PX
    return np.round(((pixels + 0.5) * scale - 0.5) * 16.0).astype(np.int32)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the device files and one drawn image."""
    path = tmp_path_factory.mktemp("geometry")
    (path / "guide.toml").write_text(GUIDE_TOML)
    (path / "carm.toml").write_text(CARM_TOML)
    image = drawn(pose())
    cv2.imwrite(str(path / "image.png"), image)
    cv2.imwrite(str(path / "flipped.png"), np.fliplr(image))
    cv2.imwrite(str(path / "blank.png"), np.full((SIDE_PX, SIDE_PX), 30_000, np.uint16))
    (path / "broken.png").write_bytes(b"\x89PNG\r\n\x1a\nno more")
    return path


def run(*arguments: str | Path) -> Result:
    """The command, run in this process."""
    return CliRunner().invoke(app, [str(argument) for argument in arguments])


def devices(folder: Path) -> tuple[str | Path, ...]:
    """The options that name the device files."""
    return ("--guide", folder / "guide.toml", "--carm", folder / "carm.toml")


def only_line(result: Result) -> dict[str, Any]:
    """The one JSON object on stdout."""
    (line,) = result.stdout.splitlines()
    parsed = json.loads(line)
    assert isinstance(parsed, dict)
    return parsed


@pytest.fixture(scope="module")
def registration_file(folder: Path) -> Path:
    """The output of `coaxial register` for the drawn image."""
    result = run("register", folder / "image.png", *devices(folder))
    assert result.exit_code == 0, result.output
    path = folder / "registration.json"
    path.write_text(result.stdout)
    return path


def test_register_prints_what_the_contract_promises(registration_file: Path, folder: Path) -> None:
    printed = json.loads(registration_file.read_text())
    assert printed["status"] == "registered"
    assert printed["image"]["path"] == str(folder / "image.png")
    assert (printed["image"]["rows"], printed["image"]["columns"]) == (SIDE_PX, SIDE_PX)
    assert printed["method"] == "contour"
    assert set(printed["intrinsics_px"]) == {"alpha_x", "alpha_y", "u0", "v0"}
    assert len(printed["fiducials_px"]) == 12
    assert set(printed["rings_px"]["big"]) == {"centre", "semi_axes", "angle_rad"}
    assert {"balls", "rms_px"} <= set(printed["distortion"])
    assert set(printed["predicted_error_95"]) == {"angle_deg", "position_mm", "depth_mm"}
    assert printed["residual_rms_px"] > 0.0
    assert printed["elapsed_ms"] > 0.0
    # degrees of the guide's axis; the drawing is coarse, and tilt trades with the principal point
    axis = np.array(printed["source_from_guide"])[:3, 2]
    assert np.degrees(np.arccos(axis @ pose()[:3, 2])) < 1.0


def test_target_works_from_the_registration_alone(registration_file: Path) -> None:
    result = run("target", registration_file, "--pixel", "600,480", "--space", "raw")
    assert result.exit_code == 0, result.output
    printed = only_line(result)
    guide_from_goal = np.array(printed["guide_from_goal"])
    assert guide_from_goal[:3, 3].tolist() == printed["translation_mm"]
    turn = Rotation.from_rotvec(np.array(printed["rotation_axis"]) * printed["rotation_deg"], degrees=True)
    assert guide_from_goal[:3, :3] == pytest.approx(turn.as_matrix(), abs=1e-12)
    assert printed["target_corrected_px"] == [600.0, 480.0]
    assert printed["predicted_error_95"]["depth_mm"] == 80.0
    ray = np.array([600.0 - CENTRE_PX, 480.0 - CENTRE_PX, ALPHA_PX])
    axis = pose()[:3, :3] @ guide_from_goal[:3, 2]
    # degrees from the true ray: the drawing's own error
    assert np.degrees(np.linalg.norm(np.cross(axis, ray / np.linalg.norm(ray)))) < 0.15


def test_evaluate_measures_the_guide_where_it_is(folder: Path) -> None:
    arguments = (*devices(folder), "--pixel", "549.43,492.54", "--space", "raw", "--depth-mm", "80")
    result = run("evaluate", folder / "image.png", *arguments)
    assert result.exit_code == 0, result.output
    printed = only_line(result)
    ray = np.array([549.43 - CENTRE_PX, 492.54 - CENTRE_PX, ALPHA_PX])
    truth_deg = np.degrees(np.arccos(pose()[:3, 2] @ ray / np.linalg.norm(ray)))
    assert printed["contour"]["angle_error_deg"] == pytest.approx(truth_deg, abs=0.5)
    assert {"angle_error_deg", "position_error_mm"} <= set(printed["paper"])
    assert isinstance(printed["agree"], bool)
    assert printed["image"]["path"] == str(folder / "image.png")


def test_flipped_image_is_refused_as_mirrored_and_the_others_are_still_registered(folder: Path) -> None:
    images = [folder / name for name in ("flipped.png", "image.png", "blank.png", "broken.png")]
    result = run("register", *images, *devices(folder))
    assert result.exit_code == 3
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    assert [line["status"] for line in lines] == ["refused", "registered", "refused", "refused"]
    assert lines[0]["reason"]["code"] == "mirrored"
    assert lines[3]["reason"]["code"] == "unreadable_image"
    assert [line["image"]["path"] for line in lines] == [str(path) for path in images]
    assert set(lines[2]["reason"]) == {"code", "message", "measured", "limit"}


def test_many_images_are_answered_in_their_order_with_progress_beside_them(folder: Path) -> None:
    names = ("blank.png", "image.png", "broken.png", "blank.png", "image.png")
    result = run("register", *(folder / name for name in names), *devices(folder))
    assert result.exit_code == 3
    lines = [json.loads(line) for line in result.stdout.splitlines()]
    assert [Path(line["image"]["path"]).name for line in lines] == list(names)
    assert [line["status"] for line in lines] == ["refused", "registered", "refused", "refused", "registered"]
    assert "5 of 5 images" in result.stderr
    # which process worked on an image changes nothing but the time it took
    (first, second) = ({k: v for k, v in lines[i].items() if k != "elapsed_ms"} for i in (1, 4))
    assert first == second


@pytest.mark.parametrize("names", [("blank", "broken", "none", "folder", "image"), ("none", "image")])
def test_a_missing_image_is_refused_with_status_2_and_the_others_are_done(folder: Path, names: tuple[str, ...]) -> None:
    (folder / "folder.png").mkdir(exist_ok=True)
    images = [folder / f"{name}.png" for name in names]
    result = run("register", *images, *devices(folder))
    assert result.exit_code == 2
    lines = {name: json.loads(line) for name, line in zip(names, result.stdout.splitlines(), strict=True)}
    assert [line["image"]["path"] for line in lines.values()] == [str(path) for path in images]
    assert lines["image"]["status"] == "registered"
    assert lines["none"]["status"] == "refused"
    assert lines["none"]["image"] == {"path": str(folder / "none.png")}
    reason = {"code": "unreadable_image", "message": "No such file or directory", "measured": None, "limit": None}
    assert lines["none"]["reason"] == reason
    told = [line for line in result.stderr.splitlines() if line.startswith("error:")]
    assert told[0] == f"error: {folder / 'none.png'}: No such file or directory"
    assert told[1:] == [f"error: {folder / 'folder.png'}: Is a directory"] * ("folder" in names)


def test_an_unreadable_image_among_many_is_refused_and_the_others_are_done(folder: Path, tmp_path: Path) -> None:
    closed = tmp_path / "closed.png"
    closed.touch(mode=0o000)
    done = subprocess.run(
        [*_WITHOUT_RIGHTS, _COAXIAL, "register", closed, folder / "blank.png", *devices(folder)],
        capture_output=True,
        text=True,
        check=False,
    )
    assert (done.returncode, done.stderr) == (2, f"error: {closed}: Permission denied\n")
    codes = [json.loads(line)["reason"]["code"] for line in done.stdout.splitlines()]
    assert codes == ["unreadable_image", "no_guide_found"]


def test_a_file_far_too_large_is_refused_by_its_size_and_never_read_whole(folder: Path, tmp_path: Path) -> None:
    huge = tmp_path / "huge.png"
    with huge.open("wb") as file:
        file.truncate(2**36)
    result = run("register", huge, *devices(folder))
    assert result.exit_code == 3
    line = only_line(result)
    assert line["image"] == {"path": str(huge)}
    reason = {"code": "image_too_large", "message": "the file's size in bytes", "measured": 2**36, "limit": 2**28}
    assert line["reason"] == reason
    assert "larger than" in run("target", huge, "--pixel", "1,2", "--space", "raw").stderr


@pytest.mark.skipif(cores() < 2, reason="with one core nothing is given to other processes")
def test_a_killed_process_among_those_that_register_ends_with_one_line(folder: Path, tmp_path: Path) -> None:
    waiting = tmp_path / "waiting.png"
    os.mkfifo(waiting)  # whoever opens it waits for somebody who writes
    images = [folder / "blank.png", waiting, *[folder / "blank.png"] * 2]
    command = [_COAXIAL, "register", *images, *devices(folder)]
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        assert running.stdout is not None
        assert running.stdout.readline()
        for child in Path(f"/proc/{running.pid}/task/{running.pid}/children").read_text().split():
            if b"spawn_main" in Path(f"/proc/{child}/cmdline").read_bytes():
                os.kill(int(child), signal.SIGKILL)
        _, said = running.communicate(timeout=60)
    assert running.returncode == 2
    errors = [line for line in said.splitlines() if not line.endswith("of 4 images")]
    assert errors == [f"error: {waiting}: not done: a process that registers images was killed. Is memory short?"]


def test_refused_image_refuses_its_evaluation(folder: Path) -> None:
    result = run("evaluate", folder / "blank.png", *devices(folder), "--pixel", "500,500", "--space", "raw")
    assert result.exit_code == 3
    assert only_line(result)["status"] == "refused"


@pytest.mark.parametrize(("pixel", "code"), [("nan,480", "target_not_finite"), ("-40,480", "target_outside_image")])
def test_target_refuses_a_bad_pixel(registration_file: Path, pixel: str, code: str) -> None:
    result = run("target", registration_file, "--pixel", pixel, "--space", "raw")
    assert result.exit_code == 3
    assert only_line(result)["reason"]["code"] == code


@pytest.mark.parametrize("content", ["", "{}", "[]", "[" * 100_000, '{"status": "refused"}', "nonsense", "\0\xff"])
def test_target_ends_with_one_line_on_what_is_no_registration(tmp_path: Path, content: str) -> None:
    path = tmp_path / "registration.json"
    path.write_text(content)
    result = run("target", path, "--pixel", "600,480", "--space", "raw")
    assert result.exit_code == 2
    assert result.stdout == ""
    assert len(result.stderr.splitlines()) == 1


def test_target_says_that_it_wants_one_line_of_several(registration_file: Path, tmp_path: Path) -> None:
    path = tmp_path / "registrations.json"
    path.write_text(registration_file.read_text() * 2)
    result = run("target", path, "--pixel", "600,480", "--space", "raw")
    assert result.exit_code == 2
    assert result.stderr.startswith(f"error: {path}: no single line of `register`: Extra data: line 2")


def test_missing_files_end_with_one_line(folder: Path) -> None:
    for arguments in (
        ("evaluate", folder / "none.png", *devices(folder), "--pixel", "600,480", "--space", "raw"),
        ("register", folder / "image.png", "--guide", folder / "none.toml", "--carm", folder / "carm.toml"),
        ("register", folder / "image.png", "--guide", folder / "guide.toml", "--carm", folder / "guide.toml"),
        ("target", folder, "--pixel", "600,480", "--space", "raw"),
    ):
        result = run(*arguments)
        assert result.exit_code == 2
        assert result.stdout == ""
        assert len(result.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ("plan-carm", "--entry", "1,2", "--target", "1,2,3"),
        ("plan-carm", "--entry", "1,2,x", "--target", "1,2,3"),
        ("plan-carm", "--entry", "1,2,3"),
        ("plan-carm", "--entry", "1,2,3", "--target", "1,2,3", "--position", "sitting"),
        ("target", "registration.json", "--pixel", "1,2"),
        ("target", "registration.json", "--pixel", "1,2", "--space", "screen"),
        ("register",),
        ("unknown",),
    ],
)
def test_wrong_usage_is_status_2(arguments: tuple[str, ...]) -> None:
    result = run(*arguments)
    assert result.exit_code == 2
    assert result.stdout == ""
    assert result.stderr


def test_plan_carm_prints_the_angles_of_a_prone_path() -> None:
    result = run("plan-carm", "--entry", "-30,80,10", "--target", "-22,40,5", "--position", "prone")
    assert result.exit_code == 0, result.output
    printed = only_line(result)
    assert printed["primary_angle_deg"] == pytest.approx(-168.6901, abs=5e-5)
    assert printed["secondary_angle_deg"] == pytest.approx(6.9880, abs=5e-5)
    assert printed["rotation_from_vertical_deg"] == pytest.approx(11.3099, abs=5e-5)


def test_plan_carm_refuses_a_path_of_no_length() -> None:
    result = run("plan-carm", "--entry", "1,2,3", "--target", "1,2,3")
    assert result.exit_code == 3
    assert only_line(result)["reason"]["code"] == "path_implausible"


@pytest.mark.parametrize("command", ["register", "target", "evaluate", "plan-carm"])
def test_help_names_every_option_and_exits_with_0(command: str) -> None:
    result = run(command, "--help")
    assert result.exit_code == 0
    assert "--help" in result.stdout


@pytest.mark.parametrize("group", [(), ("audit",), ("case",), ("db",)])
def test_help_tells_every_first_sentence_whole(group: tuple[str, ...]) -> None:
    result = run(*group, "--help")
    assert result.exit_code == 0
    assert "Commands:" in result.stdout
    assert "..." not in result.stdout.partition("Commands:")[2]


def test_the_version_is_told_as_records_name_it() -> None:
    result = run("--version")
    assert (result.exit_code, result.stdout) == (0, f"coaxial {PRODUCT_VERSION}\n")


@pytest.mark.parametrize("arguments", ["'plan-carm', '--entry', '0,80,0', '--target', '0,0,0'", "'register', '--help'"])
def test_geometry_needs_neither_web_stack_nor_database(arguments: str) -> None:
    script = (
        "import sys\n"
        "from service.cli.main import app\n"
        f"app([{arguments}], standalone_mode=False)\n"
        "import vision.registration, vision.evaluation, vision.result_json\n"
        "loaded = {'fastapi', 'starlette', 'uvicorn', 'sqlalchemy', 'alembic'} & set(sys.modules)\n"
        "sys.exit(f'loaded: {loaded}' if loaded else 0)\n"
    )
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="with one core the linear algebra has no threads anyway")
def test_a_command_calculates_without_threads_of_the_linear_algebra() -> None:
    script = (
        "import os, sys\n"
        "from service.cli.main import main\n"
        "sys.argv[1:] = ['plan-carm', '--entry', '32,85,12', '--target', '20,40,4']\n"
        "try:\n"
        "    main()\n"
        "finally:\n"
        "    assert 'numpy' in sys.modules\n"
        "    print(len(os.listdir('/proc/self/task')), file=sys.stderr)\n"
    )
    chosen = {"OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"}
    environment = {name: value for name, value in os.environ.items() if name not in chosen}
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=False, env=environment)
    assert done.stderr == "1\n"

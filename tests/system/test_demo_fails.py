"""`coaxial demo` says why it failed, and leaves nothing behind."""

import socket
import subprocess

import pytest

from tests.system.demo_process import nothing_answers, running_demo


@pytest.mark.hazard("H05")
@pytest.mark.timeout(200)
def test_a_mirrored_image_ends_the_run_with_the_reason(tmp_path):
    with running_demo(tmp_path, "--pedicle", "L3-left", "--fault", "mirrored") as demo:
        assert demo.process.wait(180) == 1, demo.out + demo.err
    assert "failed: L3-left: mirrored: " in demo.err
    assert "image refused, another exposure: mirrored" in demo.out
    assert nothing_answers(demo)


@pytest.mark.timeout(200)
def test_a_service_that_dies_is_named_and_the_room_is_ended(tmp_path):
    with running_demo(tmp_path, "--pedicle", "L3-left") as demo:
        demo.wait_for("C-arm at")
        children = demo.children()
        assert set(children) == {"serve", "simulate"}
        subprocess.run(["kill", "-9", str(children["serve"])], check=True)
        assert demo.process.wait(60) == 1
    assert "service_ended: exit status -9" in demo.err
    assert nothing_answers(demo)


def test_a_folder_that_cannot_be_made_is_named_in_one_line(tmp_path):
    (tmp_path / "file").write_text("taken")
    with running_demo(tmp_path, "--data", str(tmp_path / "file")) as demo:
        assert demo.process.wait(30) == 1
    (line,) = demo.err.splitlines()
    assert line.startswith(f"failed: room: folder_refused: {tmp_path / 'file'}")
    assert "Logs" not in line  # there are none


def test_what_no_room_has_is_told_before_a_folder_is_made(tmp_path):
    with running_demo(tmp_path, "--pedicle", "C7-left") as demo:
        assert demo.process.wait(30) == 1
    (line,) = demo.err.splitlines()
    assert line.startswith("failed: room: pedicle_unknown: C7-left; there are L1-left, ")
    assert not demo.data.exists()


@pytest.mark.timeout(200)
def test_a_start_that_fails_leaves_its_logs_and_the_folder_to_the_next(tmp_path):
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        with running_demo(tmp_path, "--pedicle", "L3-left", "--port", str(port)) as demo:
            assert demo.process.wait(120) == 1
    (line,) = demo.err.splitlines()
    assert line.startswith("failed: room: service_ended: ")
    assert line.endswith(f"Logs: {demo.data}")
    assert {file.name for file in demo.data.iterdir()} == {"room.log", "service.log"}

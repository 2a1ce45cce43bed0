"""`coaxial demo` says why it failed, and leaves nothing behind."""

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

"""`coaxial demo` places sleeves and tells how well."""

import re
import signal
import time

import pytest

from tests.system.demo_process import nothing_answers, running_demo


@pytest.mark.timeout(300)
def test_two_targets_in_two_views_are_placed_and_told_in_a_table(tmp_path):
    with running_demo(tmp_path, "--pedicle", "L3-left", "--pedicle", "L4-right") as demo:
        assert demo.process.wait(280) == 0, demo.out + demo.err
    for pedicle in ("L3-left", "L4-right"):
        row = next(line for line in demo.out.splitlines() if re.match(rf"\W*{pedicle}\W.*│", line))
        cells = [cell.strip() for cell in row.strip("│┃ ").split("│")]
        contour_deg, contour_mm = map(float, cells[3].split())
        true_deg, true_mm = map(float, cells[6].split())
        # The limits of the procedure; between what was measured and what is true lie the room's planted errors.
        assert contour_deg <= 1.0
        assert contour_mm <= 1.5
        assert true_deg <= 1.0
        assert true_mm <= 1.5
    assert "0.940" in demo.out
    assert "1.310" in demo.out
    assert "2 targets placed" in demo.out
    assert nothing_answers(demo)


@pytest.mark.timeout(200)
def test_ctrl_c_while_the_arm_moves_ends_everything(tmp_path):
    with running_demo(tmp_path, "--pedicle", "L3-left") as demo:
        demo.wait_for("C-arm at")
        time.sleep(2.0)  # into the approach
        assert demo.end(signal.SIGINT) == 130
    assert nothing_answers(demo)

"""TCP calibration files: units, ranges, and one clear line for each mistake (H09, H10)."""

from datetime import date

import numpy as np
import pytest

from robot.tool import read_tool
from tests.robot.refused_file import refused_in_one_line

FILE = """
name = "guide"
version = "3"
expires = 2030-01-31
[tcp]
translation_mm = [20.0, -5.0, 150.0]
rotation_vector_deg = [0.0, 0.0, 90.0]
[payload]
mass_kg = 0.8
centre_mm = [1.0, 0.0, 60.0]
[envelope]
radius_mm = 34.0
below_mm = 62.0
above_mm = 2.0
holder_radius_mm = 25.0
[[envelope.rod]]
name = "line"
start_mm = [26.0, 0.0, 0.0]
end_mm = [66.0, 0.0, 0.0]
radius_mm = 3.0
[tolerance]
tcp_mm = 0.1
"""


def test_file_is_read_in_its_units() -> None:
    tool = read_tool(FILE.encode())
    assert (tool.name, tool.version, tool.expires) == ("guide", "3", date(2030, 1, 31))
    assert tool.flange_from_guide @ [1.0, 0.0, 0.0, 1.0] == pytest.approx([20.0, -4.0, 150.0, 1.0])
    assert tool.payload_kg == 0.8
    assert tool.tcp_tolerance_mm == 0.1
    assert tool.tcp_tolerance_rad == pytest.approx(np.deg2rad(0.02))
    assert (tool.envelope.radius_mm, tool.envelope.rods.names) == (34.0, ("line",))
    assert len(tool.sha256) == 64


def test_tolerances_and_expiry_may_be_left_out() -> None:
    tool = read_tool(FILE.split("[tolerance]")[0].replace("expires = 2030-01-31", "").encode())
    assert tool.expires is None
    assert tool.tcp_tolerance_mm == 0.05


@pytest.mark.hazard("H09")
@pytest.mark.parametrize(
    ("before", "after", "named"),
    [
        ("[20.0, -5.0, 150.0]", "[0.02, -0.005, 0.15]", "translation_mm"),  # metres
        ("[20.0, -5.0, 150.0]", "[20000.0, -5000.0, 150000.0]", "translation_mm"),
        ("[20.0, -5.0, 150.0]", "[20.0, -5.0]", "translation_mm"),
        ("[20.0, -5.0, 150.0]", "[nan, -5.0, 150.0]", "translation_mm"),
        ("[0.0, 0.0, 90.0]", "[0.0, 0.0, 5156.0]", "rotation_vector_deg"),  # 90 x 57.3
        ("[0.0, 0.0, 90.0]", '["0", "0", "90"]', "rotation_vector_deg"),
        ("mass_kg = 0.8", "mass_kg = 800.0", "mass_kg"),  # grams
        ("mass_kg = 0.8", "", "mass_kg"),
        ("mass_kg = 0.8", "mass_kg = true", "mass_kg"),
        ("[1.0, 0.0, 60.0]", "[1.0, 0.0, 60000.0]", "centre_mm"),
        ("tcp_mm = 0.1", "tcp_mm = 100.0", "tcp_mm"),
        ("tcp_mm = 0.1", "translation_mm = 0.1", "translation_mm"),  # misspelt, not left out
        ("expires = 2030-01-31", "expire = 2020-01-31", "expire is unknown"),
        ("[tolerance]", "[tolerances]", "tolerances is unknown"),
        ('version = "3"', "", "version"),
        ('version = "3"', "version = 3", "version"),
        ("expires = 2030-01-31", 'expires = "soon"', "expires"),
        ("[payload]", "[other]", "payload"),
        ("[envelope]", "[other]", "envelope"),  # nobody would know how big the guide is (H12)
        ("radius_mm = 34.0", "radius_mm = 0.034", "radius_mm"),
        ("below_mm = 62.0", "", "below_mm"),
        ("below_mm = 62.0", "belwo_mm = 62.0", "belwo_mm"),
        ("end_mm = [66.0, 0.0, 0.0]", "", "end_mm"),
        ("[tcp]", "tcp = 3", "tcp"),
        ('name = "guide"', 'name = "guide', "TOML"),
    ],
)
def test_missing_or_implausible_value_is_named_in_one_line(before: str, after: str, named: str) -> None:
    refused_in_one_line(read_tool, FILE.replace(before, after), named)


@pytest.mark.hazard("H31")
@pytest.mark.parametrize(
    "data",
    [
        b"\xff\xfe",
        b"",
        b"name = ",
        b"name = " + b"[" * 20_000,
        b"name = 1" + b"0" * 5000,
        b"#" * 70_000,
        FILE.replace("mass_kg = 0.8", "mass_kg = 1" + "0" * 400).encode(),
        FILE.replace("[20.0, -5.0, 150.0]", f"[20, -5, 1{'0' * 400}]").encode(),
        FILE.replace('name = "guide"', r'name = "gui\u0000de"').encode(),
    ],
    ids=["bytes", "empty", "half", "nested", "digits", "long", "huge", "huge in a vector", "unprintable"],
)
def test_what_is_no_such_file_is_refused(data: bytes) -> None:
    with pytest.raises(ValueError):
        read_tool(data)


def test_the_calibrations_own_uncertainty_is_read_beside_what_it_records() -> None:
    calibration = "[calibration]\nimages = 10\ntranslation_sd_mm = 0.3\nrotation_sd_deg = 0.1\ncost_ratio = 1.1\n"
    tool = read_tool((FILE + calibration).encode())
    assert tool.calibration_sd_mm == 0.3
    assert tool.calibration_sd_rad == pytest.approx(np.deg2rad(0.1))
    assert read_tool(FILE.encode()).calibration_sd_mm == 0.1  # of a careful calibration
    with pytest.raises(ValueError, match="translation_sd is unknown"):
        read_tool((FILE + calibration.replace("translation_sd_mm", "translation_sd")).encode())

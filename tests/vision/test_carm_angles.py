import math

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from vision.carm_angles import CArmAngles, Position, carm_angles
from vision.refusal import Refusal, RefusalCode

PRINTED_DEG = 5e-5  # half a unit of the last printed digit of the table

TABLE = [
    (Position.SUPINE, (40, -110, 30), (25, -40, 10), (12.0948, 15.6089), (12.0948, 15.6089), (11.6423, 15.9454)),
    (Position.PRONE, (32, 85, 12), (20, 40, 4), (165.0686, 9.7469), (-14.9314, 9.7469), (-14.7110, 10.0806)),
    (Position.PRONE, (-30, 80, 10), (-22, 40, 5), (-168.6901, 6.9880), (11.3099, 6.9880), (11.2248, 7.1250)),
]


def planned(entry: tuple[float, ...], target: tuple[float, ...], position: Position) -> CArmAngles:
    """The angles, where none may be refused."""
    result = carm_angles(np.array(entry), np.array(target), position)
    assert isinstance(result, CArmAngles), result
    return result


@pytest.mark.parametrize(("position", "entry", "target", "dicom", "dial", "mobile"), TABLE)
def test_table_of_the_method(
    position: Position,
    entry: tuple[float, ...],
    target: tuple[float, ...],
    dicom: tuple[float, float],
    dial: tuple[float, float],
    mobile: tuple[float, float],
) -> None:
    angles = planned(entry, target, position)
    found_deg = np.degrees(
        [
            angles.primary_rad,
            angles.secondary_rad,
            angles.rotation_from_vertical_rad,
            angles.angulation_from_vertical_rad,
            angles.orbital_rad,
            angles.tilt_rad,
        ]
    )
    assert found_deg == pytest.approx((*dicom, *dial, *mobile), abs=PRINTED_DEG)


components = st.floats(-200.0, 200.0)


@given(components, components, components, st.sampled_from(list(Position)))
def test_angles_give_the_direction_of_the_path_back(x: float, y: float, z: float, position: Position) -> None:
    assume(math.hypot(x, y) > 0.05 * math.hypot(x, y, z) > 0.5)
    angles = planned((x, y, z), (0.0, 0.0, 0.0), position)
    alpha, beta = angles.primary_rad, angles.secondary_rad
    direction = np.array([math.sin(alpha) * math.cos(beta), -math.cos(alpha) * math.cos(beta), math.sin(beta)])
    assert direction == pytest.approx(np.array([x, y, z]) / math.hypot(x, y, z), abs=1e-9)
    # the mobile C-arm: tilt about the body's cross axis, then slide along the tilted orbit
    orbital, tilt = angles.orbital_rad, angles.tilt_rad
    equipment = [math.sin(orbital), math.cos(orbital) * math.cos(tilt), math.cos(orbital) * math.sin(tilt)]
    left, up = (x, -y) if position is Position.SUPINE else (-x, y)
    assert equipment == pytest.approx(np.array([left, up, z]) / math.hypot(x, y, z), abs=1e-9)


def test_straight_above_is_zero_on_the_dial_of_either_position() -> None:
    supine = planned((0, -100, 0), (0, 0, 0), Position.SUPINE)
    prone = planned((0, 100, 0), (0, 0, 0), Position.PRONE)
    assert (supine.primary_rad, supine.rotation_from_vertical_rad) == (0.0, 0.0)
    assert (prone.primary_rad, prone.rotation_from_vertical_rad) == (math.pi, 0.0)
    assert supine.words == prone.words == "detector straight above"


@pytest.mark.parametrize(
    ("position", "entry", "words"),
    [
        (Position.SUPINE, (10, -100, 0), "detector 5.7 deg towards the patient's left"),
        (Position.PRONE, (10, 100, 0), "detector 5.7 deg towards the patient's left"),
        (Position.PRONE, (-10, 100, 0), "detector 5.7 deg towards the patient's right"),
        (Position.SUPINE, (0, -100, -10), "detector 5.7 deg towards the patient's feet"),
        (
            Position.PRONE,
            (10, 100, 10),
            "detector 5.7 deg towards the patient's left and 5.7 deg towards the patient's head",
        ),
    ],
)
def test_words_say_where_the_detector_goes(position: Position, entry: tuple[float, ...], words: str) -> None:
    assert planned(entry, (0, 0, 0), position).words == words


@pytest.mark.parametrize(
    ("entry", "code"),
    [
        ((math.nan, 0.0, 0.0), RefusalCode.TARGET_NOT_FINITE),
        ((0.0, math.inf, 0.0), RefusalCode.TARGET_NOT_FINITE),
        ((0.0, 0.0, 0.0), RefusalCode.PATH_IMPLAUSIBLE),
        ((0.012, 0.045, 0.008), RefusalCode.PATH_IMPLAUSIBLE),  # metres for millimetres
        ((12_000.0, 45_000.0, 8000.0), RefusalCode.PATH_IMPLAUSIBLE),
        ((0.0, 0.0, 60.0), RefusalCode.PATH_IMPLAUSIBLE),  # along the body
    ],
)
def test_path_that_no_carm_can_look_along_is_refused(entry: tuple[float, ...], code: RefusalCode) -> None:
    refusal = carm_angles(np.array(entry), np.zeros(3), Position.PRONE)
    assert isinstance(refusal, Refusal)
    assert refusal.code is code

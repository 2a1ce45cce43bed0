"""Distances from keep-out shapes: against brute force and against a library of collision checks."""

import coal
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robot.shapes import Box, Cylinder, HalfSpace, Occupant, Shape, segment_distance

MILLIMETRES = st.floats(-300.0, 300.0)
POINT = st.tuples(MILLIMETRES, MILLIMETRES, MILLIMETRES).map(np.array)
SIZE = st.floats(10.0, 200.0)
TURN = st.tuples(*[st.floats(-3.0, 3.0)] * 3).map(lambda turn: Rotation.from_rotvec(turn).as_matrix())


def pose(rotation: np.ndarray, origin_mm: np.ndarray) -> np.ndarray:
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = rotation, origin_mm
    return transform


BOXES = st.builds(
    lambda turn, centre, half: Box("box", Occupant.OTHER, pose(turn, centre), np.array(half)),
    TURN,
    POINT,
    st.tuples(SIZE, SIZE, SIZE),
)
CYLINDERS = st.builds(
    lambda start, turn, length, radius: Cylinder(
        "cylinder", Occupant.OTHER, start, start + length * turn[:, 2], radius
    ),
    POINT,
    TURN,
    SIZE,
    SIZE,
)
HALF_SPACES = st.builds(lambda point, turn: HalfSpace("wall", Occupant.OTHER, point, turn[:, 0]), POINT, TURN)


@settings(max_examples=60)
@given(shape=st.one_of(BOXES, CYLINDERS, HALF_SPACES), start=POINT, end=POINT)
def test_no_point_of_a_segment_is_nearer_than_its_distance_and_one_is_as_near(
    shape: Shape, start: np.ndarray, end: np.ndarray
) -> None:
    shares = np.linspace(0.0, 1.0, 4001)[:, None]
    brute_mm = float(shape.distance_mm(start + shares * (end - start)).min())
    step_mm = float(np.linalg.norm(end - start)) / 4000.0
    found_mm = float(segment_distance(shape, start, end))
    rounding_mm = 1e-9  # of sums of products of lengths up to some thousand mm
    assert brute_mm - step_mm - rounding_mm <= found_mm <= brute_mm + 1e-4


@settings(max_examples=60)
@given(shape=st.one_of(BOXES, CYLINDERS), start=POINT, end=POINT)
def test_distance_outside_agrees_with_the_library(shape: Shape, start: np.ndarray, end: np.ndarray) -> None:
    length_mm = float(np.linalg.norm(end - start))
    if length_mm < 1.0:
        return
    capsule = coal.Capsule(1.0, length_mm)
    expected = coal.DistanceResult()
    request = coal.DistanceRequest()
    coal.distance(capsule, _along(start, end), *_in_coal(shape), request, expected)
    found_mm = float(segment_distance(shape, start, end)) - 1.0
    if found_mm > 1e-3:
        assert found_mm == pytest.approx(expected.min_distance, abs=1e-3)
    else:
        assert expected.min_distance < 2e-3


def _in_coal(shape: Shape) -> tuple[object, object]:
    if isinstance(shape, Box):
        place = coal.Transform3s(shape.base_from_box[:3, :3], shape.base_from_box[:3, 3])
        return coal.Box(*(2.0 * shape.half_mm)), place
    assert isinstance(shape, Cylinder)
    length_mm = float(np.linalg.norm(shape.end_mm - shape.start_mm))
    return coal.Cylinder(shape.radius_mm, length_mm), _along(shape.start_mm, shape.end_mm)


def _along(start: np.ndarray, end: np.ndarray) -> object:
    """A place whose z runs from start to end, with its origin in the middle."""
    turn, _ = Rotation.align_vectors([(end - start) / np.linalg.norm(end - start)], [[0.0, 0.0, 1.0]])
    return coal.Transform3s(turn.as_matrix(), (start + end) / 2.0)


@pytest.mark.parametrize(
    ("shape", "point", "expected_mm"),
    [
        (Box("b", Occupant.TABLE, np.eye(4), np.array([10.0, 20.0, 30.0])), [13.0, 24.0, 0.0], 5.0),
        (Box("b", Occupant.TABLE, np.eye(4), np.array([10.0, 20.0, 30.0])), [0.0, 18.0, 0.0], -2.0),
        (Cylinder("c", Occupant.PATIENT, np.zeros(3), np.array([0.0, 0.0, 50.0]), 10.0), [13.0, 0.0, 54.0], 5.0),
        (Cylinder("c", Occupant.PATIENT, np.zeros(3), np.array([0.0, 0.0, 50.0]), 10.0), [4.0, 0.0, 25.0], -6.0),
        (HalfSpace("h", Occupant.OTHER, np.array([0.0, 0.0, 5.0]), np.array([0.0, 0.0, 1.0])), [9.0, 9.0, 2.0], -3.0),
    ],
)
def test_distance_is_negative_inside_and_counts_corners(shape: Shape, point: list[float], expected_mm: float) -> None:
    assert float(shape.distance_mm(np.array(point))) == pytest.approx(expected_mm)

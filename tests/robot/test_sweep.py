"""Keep-out shapes along a path (H12): what is refused and where, and that nothing slips through between samples."""

from dataclasses import replace
from pathlib import Path as Paths

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from robot.envelope import carried
from robot.kinematics import base_from_flange
from robot.line import line_between, sample_line
from robot.path import Path, Way, plan_path
from robot.path_limits import PathLimits
from robot.refusal import Refusal, RefusalCode
from robot.room_shapes import RoomShapes, read_room
from robot.shapes import Box, Cylinder, HalfSpace, Occupant, Shape, segment_distance
from robot.tool import read_tool
from tests.robot.refused_file import refused_in_one_line

DEVICES = Paths(__file__).parents[1] / "devices"
FAR_ROOM = read_room((DEVICES / "room.toml").read_bytes())
TOOL = read_tool(
    (DEVICES / "tcp.toml")
    .read_bytes()
    .replace(b"[20.0, -5.0, 150.0]", b"[0.0, -30.0, 150.0]")
    .replace(b"[0.0, 0.0, 0.0]", b"[69.282, -69.282, 69.282]")
)
JOINTS_RAD = np.deg2rad([0.0, -90.0, 90.0, -90.0, -90.0, 0.0])
START = base_from_flange(JOINTS_RAD) @ TOOL.flange_from_guide


def room_with(*shapes: Shape) -> RoomShapes:
    return replace(FAR_ROOM, shapes=(*FAR_ROOM.shapes, *shapes))


def cube(name: str, centre_mm: np.ndarray, side_mm: float = 20.0) -> Box:
    place = np.eye(4)
    place[:3, 3] = centre_mm
    return Box(name, Occupant.OTHER, place, np.full(3, side_mm / 2.0))


def ahead(offset_mm: list[float], turn_deg: list[float] | None = None) -> np.ndarray:
    """A goal in the guide's own frame."""
    step = np.eye(4)
    step[:3, :3] = Rotation.from_rotvec(turn_deg or [0.0] * 3, degrees=True).as_matrix()
    step[:3, 3] = offset_mm
    return START @ step


def way(goal: np.ndarray, room: RoomShapes, leaving: bool = False) -> Path | Refusal:
    return plan_path(Way(JOINTS_RAD, START, goal, leaving), TOOL, room, PathLimits())


@pytest.mark.hazard("H12")
def test_obstacle_on_any_segment_is_no_plan_and_the_refusal_says_which_what_and_how_near() -> None:
    goal = ahead([0.0, 0.0, -100.0])
    samples = sample_line(line_between(START, goal))
    for segment in range(45, len(samples) - 1, 5):  # nearer ones the guide stands in already
        below = samples[segment] @ np.array([0.0, 20.0, -62.0, 1.0])
        refusal = way(goal, room_with(cube("lamp", below[:3])))
        assert isinstance(refusal, Refusal), segment
        assert refusal.code is RefusalCode.KEEP_OUT
        assert "lamp" in refusal.message
        assert "guide" in refusal.message
        assert f"of {len(samples) - 1}" in refusal.message
        assert refusal.measured is not None
        assert refusal.measured < 0.0
        assert refusal.limit == 5.0


def test_only_the_segment_that_comes_too_near_is_named() -> None:
    goal = ahead([0.0, 0.0, -100.0])
    beside = (START @ np.array([34.0 + 10.0 + 8.0, 0.0, -62.0 - 60.0, 1.0]))[:3]
    near = way(goal, room_with(cube("lamp", beside)))
    assert isinstance(near, Path)  # 8 mm away and 5 are asked
    assert near.clearance_mm == pytest.approx(8.0, abs=2.5)  # less the slack, and the rods of the body are a mm wide
    preview = [near.swept.on_segment(segment) for segment in range(len(near.swept.clearances_mm))]
    nearest = min(preview, key=lambda one: one.clearance_mm)
    assert nearest == near.swept.nearest
    assert (nearest.shape, nearest.part) == ("lamp", "guide")
    assert nearest.segment >= 20


@pytest.mark.parametrize(
    ("part", "point_in_link"),
    [
        ("wrist 1", (4, 0.5, 0.0)),
        ("wrist 2", (5, 0.5, 0.0)),
        ("wrist 3", (6, 0.5, 0.0)),
        ("forearm", (3, 0.5, 16.15)),
        ("elbow", (2, 1.0, 75.0)),
        ("upper arm", (2, 0.5, 135.85)),
        ("shoulder", (1, 1.0, 60.0)),
    ],
)
def test_arm_from_shoulder_to_wrist_is_kept_out_too(part: str, point_in_link: tuple[int, float, float]) -> None:
    """Points on the axes of a UR5's housings, as its drawings have them aside from the plane of its joints."""
    from robot.kinematics import link_frames

    frames = link_frames(JOINTS_RAD)
    link, share, aside_mm = point_in_link
    centre = frames[link - 1, :3, 3] + share * (frames[link, :3, 3] - frames[link - 1, :3, 3])
    centre = centre + aside_mm * frames[3, :3, 2]
    refusal = way(ahead([0.0, 0.0, 5.0]), room_with(cube("pole", centre, 10.0)))
    assert isinstance(refusal, Refusal)
    assert part in refusal.message


POINT = st.tuples(*[st.floats(-150.0, 150.0)] * 3).map(np.array)
NEAR_SHAPES = st.one_of(
    st.builds(lambda p, s: cube("a", START[:3, 3] + p, s), POINT, st.floats(10.0, 80.0)),
    st.builds(
        lambda p, q: Cylinder("b", Occupant.OTHER, START[:3, 3] + p, START[:3, 3] + p + q + [0.0, 0.0, 400.0], 15.0),
        POINT,
        POINT,
    ),
    st.builds(
        lambda p, t: HalfSpace("c", Occupant.OTHER, START[:3, 3] + p, Rotation.from_rotvec(t).as_matrix()[:, 0]),
        POINT,
        POINT.map(lambda p: p / 50.0),
    ),
)


@settings(max_examples=8)
@given(
    shape=NEAR_SHAPES,
    offset_mm=st.lists(st.floats(-40.0, 40.0), min_size=3, max_size=3),
    turn_deg=st.lists(st.floats(-15.0, 15.0), min_size=3, max_size=3),
)
def test_clearance_is_a_lower_bound_of_a_much_finer_sweep(
    shape: Shape, offset_mm: list[float], turn_deg: list[float]
) -> None:
    room = replace(FAR_ROOM, shapes=(shape,), clearance_mm=-1e4)  # whatever it is, it is a path
    path = way(ahead(offset_mm, turn_deg), room)
    if isinstance(path, Refusal):
        assert path.code is not RefusalCode.KEEP_OUT
        return
    body = carried(TOOL.envelope, TOOL.flange_from_guide)
    parts = len(body.names)
    bounds_mm = path.swept.clearances_mm[:, :parts, 0].min(axis=1)
    for segment, bound_mm in enumerate(bounds_mm):
        piece = line_between(*path.base_from_samples[segment : segment + 2])
        for pose in _between(piece.base_from_start, piece.base_from_goal):
            starts = body.starts_mm @ pose[:3, :3].T + pose[:3, 3]
            ends = body.ends_mm @ pose[:3, :3].T + pose[:3, 3]
            true_mm = float((segment_distance(shape, starts, ends) - body.radii_mm).min())
            assert bound_mm <= true_mm + 1e-3
            assert bound_mm >= true_mm - 8.0  # and no wild guess: 2 mm and 0.5 deg apart


@pytest.mark.hazard("H12")
def test_thing_that_is_passed_exactly_between_two_samples_is_seen() -> None:
    goal = ahead([40.0, 0.0, 0.0])
    samples = sample_line(line_between(START, goal))
    body = carried(TOOL.envelope, TOOL.flange_from_guide)
    halfway = (samples[10] + samples[11]) / 2.0
    widest_mm = float((body.starts_mm[:36, 1] + body.radii_mm[:36]).max())
    splinter = cube("splinter", (halfway @ np.array([0.0, widest_mm + 0.3, -30.0, 1.0]))[:3], 0.1)
    path = way(goal, replace(FAR_ROOM, shapes=(splinter,), clearance_mm=-1e4))
    assert isinstance(path, Path)
    starts, ends = (ends_mm @ halfway[:3, :3].T + halfway[:3, 3] for ends_mm in (body.starts_mm, body.ends_mm))
    true_mm = float((segment_distance(splinter, starts, ends) - body.radii_mm).min())
    assert 0.2 < true_mm < 0.3
    assert path.clearance_mm <= true_mm


def _between(start: np.ndarray, goal: np.ndarray) -> list[np.ndarray]:
    turn = Rotation.from_matrix(start[:3, :3].T @ goal[:3, :3]).as_rotvec()
    poses = []
    for share in (0.25, 0.5, 0.75):
        pose = start.copy()
        pose[:3, :3] = start[:3, :3] @ Rotation.from_rotvec(share * turn).as_matrix()
        pose[:3, 3] += share * (goal[:3, 3] - start[:3, 3])
        poses.append(pose)
    return poses


def test_arm_that_stands_too_near_may_leave_along_its_axis_but_come_no_nearer() -> None:
    under = ahead([0.0, 0.0, -68.0 - 25.0])
    room = room_with(Box("back", Occupant.PATIENT, under, np.array([100.0, 100.0, 25.0])))
    # 2 mm below the body's end, of which its rods take 4
    upwards, downwards = ahead([0.0, 0.0, 60.0]), ahead([0.0, 0.0, -3.0])
    assert isinstance(way(upwards, room), Refusal)
    leaving = way(upwards, room, leaving=True)
    assert isinstance(leaving, Path)
    assert leaving.clearance_mm >= leaving.needed_mm
    assert leaving.needed_mm < 5.0
    assert isinstance(way(downwards, room, leaving=True), Refusal)


def test_body_of_rods_covers_the_whole_surface_of_the_guide_and_hardly_more() -> None:
    body = carried(TOOL.envelope, TOOL.flange_from_guide)
    angles = np.linspace(0.0, 2.0 * np.pi, 721)
    for z_mm in (-62.0, -30.0, 2.0):
        rim = np.column_stack([34.0 * np.cos(angles), 34.0 * np.sin(angles), np.full_like(angles, z_mm)])
        along = np.clip(rim[:, None, 2], body.starts_mm[:36, 2], body.ends_mm[:36, 2])
        nearest = np.hypot(np.linalg.norm(rim[:, None, :2] - body.starts_mm[:36, :2], axis=-1), rim[:, None, 2] - along)
        assert (nearest.min(axis=1) <= body.radii_mm[0] + 1e-9).all()
    reach_mm = np.linalg.norm(body.starts_mm[:36, :2], axis=1) + body.radii_mm[:36]
    assert reach_mm.max() <= 34.0 + 2.0


ROOM = (DEVICES / "room.toml").read_text()


@pytest.mark.hazard("H09")
@pytest.mark.parametrize(
    ("before", "after", "named"),
    [
        ("clearance_mm = 5.0", "clearance_mm = 0.005", "clearance_mm"),  # metres
        ("clearance_mm = 5.0", "", "clearance_mm"),
        ("radius_mm = 150.0", "radius_mm = 0.15", "radius_mm"),
        ("size_mm = [600.0, 2000.0, 50.0]", "size_mm = [600.0, 2000.0, 0.0]", "size_mm"),
        ("centre_mm = [-900.0, 0.0, -500.0]", "centre_mm = [-900000.0, 0.0, -500.0]", "centre_mm"),
        ("end_mm = [-900.0, 600.0, -300.0]", "end_mm = [-900.0, -600.0, -300.0]", "end_mm"),
        ("normal = [0.0, 0.0, -1.0]", "normal = [0.0, 0.0, 0.0]", "normal"),
        ('occupant = "patient"', 'occupant = "patience"', "patience"),
        ('occupant = "table"', 'occupant = "other"', "table"),  # forgotten: the arm would go through it
        ('occupant = "intensifier"', 'occupant = "other"', "intensifier"),
        ('name = "trunk"', 'name = "table top"', "same name"),
        ("[[cylinder]]", "[cylinder]", "cylinder"),
        ("[[half_space]]", "[[halfspace]]", "halfspace"),
        ("radius_mm = 150.0", "radius_mm = 150.0\nraduis_mm = 1.0", "raduis_mm"),
    ],
)
def test_room_file_that_says_too_little_or_too_much_is_refused_in_one_line(before: str, after: str, named: str) -> None:
    refused_in_one_line(read_room, ROOM.replace(before, after, 1), named)

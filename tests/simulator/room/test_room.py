"""The room's own sums: guide, beam and patient in one frame, and what is hidden there."""

from collections.abc import Callable

import numpy as np
import pytest

from simulator.carm.geometry import Angles, angles_of
from simulator.carm.guide import Part
from simulator.devices import read_mounting
from simulator.faults import RoomFault
from simulator.frames import PARKED_RAD, ROOM_FROM_BASE, ROOM_FROM_PATIENT, inverse
from simulator.kinematics import NOMINAL_UR5, base_from_flange, jacobian, solve_joints
from simulator.room import Room
from simulator.truth import read_truth

_NAME = "L4-left"


def _face(room: Room, name: str) -> None:
    pedicle = room.pedicle(name)
    room.position(angles_of(pedicle.entry_in_patient, pedicle.target_in_patient))


def test_exactly_aligned_guide_has_no_error(room: Room, aligned: Callable) -> None:
    _face(room, _NAME)
    aligned(_NAME)
    found = room.errors(_NAME)
    assert found.angle_rad < 1e-9
    assert found.position_mm < 1e-6


def test_errors_are_those_that_were_made(room: Room, aligned: Callable) -> None:
    _face(room, _NAME)
    aligned(_NAME, shift_mm=(0.6, 0.8, 0.0))
    assert room.errors(_NAME).position_mm == pytest.approx(1.0, abs=1e-6)
    aligned(_NAME, turn_rad=(0.02, 0.0, 0.0))
    assert room.errors(_NAME).angle_rad == pytest.approx(0.02, abs=1e-9)


def test_aligned_guide_surrounds_the_pedicle_in_the_image(room: Room, aligned: Callable) -> None:
    _face(room, _NAME)
    aligned(_NAME)
    scene = room.scene()
    guide = scene.guides[0].source_from_guide
    pose = scene.source_from_patient
    target = pose[:3, :3] @ room.pedicle(_NAME).target_in_patient + pose[:3, 3]
    centres = [guide[:3, 3], (guide @ [0.0, 0.0, -60.0, 1.0])[:3], target]
    pixels = scene.camera.project(np.array(centres))
    np.testing.assert_allclose(pixels, pixels[[0, 0, 0]], atol=1e-6)
    assert np.linalg.norm(guide[:3, 3]) == pytest.approx(765.0)


def test_breath_moves_the_anatomy_by_its_amplitude(arm) -> None:
    still, inhaled = (Room(arm, read_truth(), now_s=lambda t=t: t).scene() for t in (0.0, 4.2 / 4.0))
    shift = inhaled.source_from_patient[:3, 3] - still.source_from_patient[:3, 3]
    assert np.linalg.norm(shift) == pytest.approx(0.5, abs=1e-3)


def test_carm_is_centred_on_the_pedicle_that_fits_its_angles(room: Room) -> None:
    for name in room.patient.pedicles:
        _face(room, name)
        target = (ROOM_FROM_PATIENT @ [*room.pedicle(name).target_in_patient, 1.0])[:3]
        assert np.linalg.norm(room.stand.isocentre_in_room - target) < 6.0 * 4.0  # mm, four sd of the centring


def test_every_pedicle_projects_into_the_field_when_it_is_faced(room: Room) -> None:
    for name in room.patient.pedicles:
        _face(room, name)
        scene = room.scene()
        pose = scene.source_from_patient
        pixel = scene.camera.project(pose[:3, :3] @ room.pedicle(name).target_in_patient + pose[:3, 3])
        assert np.linalg.norm(pixel - 511.5) < 200.0


def test_arm_reaches_every_approach_from_the_parked_pose_far_from_singularities(room: Room) -> None:
    flange_from_guide = read_mounting().flange_from_guide
    parked = np.array(PARKED_RAD)
    start = base_from_flange(NOMINAL_UR5, parked)
    for name in room.patient.pedicles:
        _face(room, name)
        goal = room.approach(name) @ inverse(flange_from_guide)
        joints = solve_joints(NOMINAL_UR5, goal, parked)
        assert joints is not None
        assert np.abs(joints - parked).max() < np.deg2rad(60.0)
        for share in np.linspace(0.0, 1.0, 5):
            step = goal.copy()
            step[:3, 3] = start[:3, 3] + share * (goal[:3, 3] - start[:3, 3])
            on_way = solve_joints(NOMINAL_UR5, step, parked)
            assert on_way is not None
            scaled = jacobian(NOMINAL_UR5, on_way) / np.array([[300.0]] * 3 + [[1.0]] * 3)
            assert np.linalg.svd(scaled, compute_uv=False)[-1] > 0.1


def test_approach_by_eye_is_off_but_within_the_beam(room: Room) -> None:
    _face(room, _NAME)
    source = room.stand.room_from_source()
    places = []
    for _ in range(30):
        in_source = inverse(source) @ ROOM_FROM_BASE @ room.approach(_NAME)
        places.append(in_source[:3, 3])
        assert in_source[2, 2] > np.cos(np.deg2rad(20.0))
    spread = np.std(places, axis=0)
    assert np.all((spread > 2.5) & (spread < 8.0))  # mm, about 5


def test_arm_out_of_the_beam_leaves_no_guide_in_the_image(room: Room) -> None:
    _face(room, _NAME)
    scene = room.scene()
    u = scene.camera.project(scene.guides[0].source_from_guide[:3, 3])[0]
    assert not 0.0 < u < 1023.0


def test_turned_carm_keeps_its_dials(room: Room) -> None:
    _face(room, _NAME)
    before = room.stand
    room.inject(RoomFault.CARM_TURNED)
    after = room.stand
    turn = np.arccos(before.room_from_source()[:3, 2] @ after.room_from_source()[:3, 2])
    assert np.rad2deg(turn) == pytest.approx(1.0, abs=0.05)
    assert after.angles == before.angles
    room.clear(RoomFault.CARM_TURNED)
    assert np.array_equal(room.stand.room_from_source(), before.room_from_source())


def test_who_exposes_at_expiration_sees_the_patient_at_one_place(arm) -> None:
    places = []
    for start_s in (0.3, 1.9, 4.1, 100.0):
        wait_s = Room(arm, read_truth(), now_s=lambda t=start_s: t).until_expiration_s()
        assert 0.0 <= wait_s < 4.2
        scene = Room(arm, read_truth(), now_s=lambda t=start_s + wait_s: t).scene()
        places.append(scene.source_from_patient[:3, 3])
    assert np.ptp(places, axis=0).max() < 1e-9


def test_a_shifted_carm_and_a_pushed_base_displace_the_guide_in_the_image_by_as_much(
    room: Room, aligned: Callable
) -> None:
    _face(room, _NAME)
    aligned(_NAME)
    before = room.scene().guides[0].source_from_guide
    for fault in (RoomFault.CARM_SHIFTED, RoomFault.BASE_PUSHED):
        room.inject(fault)
        moved = room.scene().guides[0].source_from_guide
        assert np.linalg.norm(moved[:3, 3] - before[:3, 3]) == pytest.approx(8.0)
        np.testing.assert_allclose(moved[:3, :3], before[:3, :3], atol=1e-12)
        room.clear(fault)


def test_a_scaled_guide_is_larger_throughout(room: Room) -> None:
    shape = room.scene().guides[0].shape
    room.inject(RoomFault.GUIDE_SCALED)
    larger = room.scene().guides[0].shape
    assert larger.big_radius_mm == pytest.approx(1.03 * shape.big_radius_mm)
    assert larger.bead_mm == pytest.approx([1.03 * one for one in shape.bead_mm])
    assert larger.wire_diameter_mm == pytest.approx(1.03 * shape.wire_diameter_mm)


def test_shifted_anatomy_moves_target_and_image_by_a_millimetre(room: Room, aligned: Callable) -> None:
    _face(room, _NAME)
    aligned(_NAME)
    before = room.scene().source_from_patient[:3, 3]
    room.inject(RoomFault.ANATOMY_SHIFT)
    assert np.linalg.norm(room.scene().source_from_patient[:3, 3] - before) == pytest.approx(1.0)
    assert 0.8 < room.errors(_NAME).position_mm < 1.01


def test_scene_faults_change_what_is_seen(room: Room) -> None:
    assert room.scene().plate is not None
    for fault in (RoomFault.NO_PLATE, RoomFault.NO_BEAD, RoomFault.LOW_DOSE):
        room.inject(fault)
    scene = room.scene()
    assert scene.plate is None
    assert Part.BEAD not in scene.guides[0].shape.parts
    assert scene.exposure.photons < 0.05 * read_truth().carm.photons
    room.clear()
    assert room.scene().plate is not None


def test_cart_gives_way_once_after_the_guide_was_seen(room: Room, arm, aligned: Callable) -> None:
    _face(room, _NAME)
    aligned(_NAME)
    joints = np.array(PARKED_RAD)
    room.scene()
    assert room.errors(_NAME).position_mm < 1e-6
    for shift in (0.01, 0.02):
        arm.put(arm.state().base_from_flange_true, joints + shift)
        assert 1.25 < room.errors(_NAME).position_mm < 1.61


def test_planted_errors_have_the_sizes_of_the_truth(room: Room) -> None:
    error = inverse(read_mounting().flange_from_guide) @ room.planted.flange_from_guide
    assert np.linalg.norm(error[:3, 3]) == pytest.approx(0.3)
    assert np.rad2deg(np.arccos((np.trace(error[:3, :3]) - 1.0) / 2.0)) == pytest.approx(0.1)
    shape = room.planted.shape
    assert abs(shape.small_radius_mm - 20.0) == pytest.approx(0.05)
    assert abs(shape.big_radius_mm - 30.0) == pytest.approx(0.05)


def test_unknown_pedicle_and_impossible_angles_are_refused(room: Room) -> None:
    with pytest.raises(KeyError):
        room.errors("T12-left")
    with pytest.raises(ValueError, match="table"):
        room.position(Angles(np.nan, 0.0))

"""Each fault changes what it says, by as much as it says."""

from dataclasses import fields

import numpy as np
import pytest

from simulator.carm.faulted import Fault, faulted_scene
from simulator.carm.guide import ALL_PARTS, GuideShape, Part
from simulator.carm.scene import Scene

_SEEDS = range(6)
_DIMENSIONS = {
    Fault.SMALL_RADIUS: "small_radius_mm",
    Fault.BIG_RADIUS: "big_radius_mm",
    Fault.SEPARATION: "separation_mm",
    Fault.LINE_START: "line_start_mm",
    Fault.LINE_END: "line_end_mm",
    Fault.WIRE_DIAMETER: "wire_diameter_mm",
    Fault.BEAD_DIAMETER: "bead_diameter_mm",
}
_MADE_MM = 0.1  # five sd of the manufacture of one group


def _shape(scene: Scene) -> GuideShape:
    return scene.guides[0].shape


@pytest.mark.parametrize(("fault", "name"), _DIMENSIONS.items())
def test_one_dimension_is_off_by_three_to_ten_per_cent_and_no_other(fault: Fault, name: str) -> None:
    for seed in _SEEDS:
        made, meant = _shape(faulted_scene(fault, seed).scene), GuideShape()
        for field in fields(GuideShape):
            value, should = getattr(made, field.name), getattr(meant, field.name)
            if field.name == name:
                assert 0.027 < abs(value / should - 1.0) < 0.103
            elif isinstance(should, float):
                assert abs(value - should) < _MADE_MM
            else:
                assert value == should


@pytest.mark.parametrize(("fault", "axis"), [(Fault.BEAD_Y, 1), (Fault.BEAD_Z, 2)])
def test_bead_is_off_along_one_axis(fault: Fault, axis: int) -> None:
    for seed in _SEEDS:
        off = np.subtract(_shape(faulted_scene(fault, seed).scene).bead_mm, GuideShape().bead_mm)
        assert np.count_nonzero(off) == 1
        assert 0.03 <= abs(off[axis] / GuideShape().bead_mm[axis]) <= 0.10


@pytest.mark.parametrize(
    ("fault", "part"),
    [
        (Fault.SMALL_RING_HIDDEN, Part.SMALL_RING),
        (Fault.BIG_RING_HIDDEN, Part.BIG_RING),
        (Fault.LINE_HIDDEN, Part.LINE),
        (Fault.BEAD_HIDDEN, Part.BEAD),
    ],
)
def test_one_part_is_hidden(fault: Fault, part: Part) -> None:
    assert _shape(faulted_scene(fault, 1).scene).parts == ALL_PARTS - {part}


@pytest.mark.parametrize("fault", [Fault.DECOY_RINGS, Fault.INSTRUMENTS, Fault.SECOND_GUIDE])
def test_other_things_come_after_the_guide(fault: Fault) -> None:
    for seed in _SEEDS:
        first, *others = faulted_scene(fault, seed).scene.guides
        assert first.shape.parts == ALL_PARTS
        assert others
        assert all(np.isclose(np.linalg.det(other.source_from_guide), 1.0) for other in others)


def test_every_flip_is_a_mirror_image_and_all_four_are_drawn() -> None:
    pixels = np.array([[1, 2], [3, 4]], dtype=np.uint8)
    flips = [faulted_scene(Fault.MIRRORED, seed).flip for seed in range(20)]
    assert {flip(pixels).tobytes() for flip in flips if flip} == {
        bytes(rows) for rows in ([2, 1, 4, 3], [3, 4, 1, 2], [1, 3, 2, 4], [4, 2, 3, 1])
    }


def test_zoom_changes_the_pixel_and_moves_the_principal_point_with_the_image() -> None:
    for seed in _SEEDS:
        camera = faulted_scene(Fault.ZOOMED, seed).scene.camera
        factor = 360.0 / 1024.0 / camera.pixel_mm
        assert 0.03 <= abs(factor - 1.0) <= 0.25
        assert abs(camera.principal_u_px - 511.5) <= 12.0 * factor


def test_intensifier_without_plate_or_with_the_wrong_file() -> None:
    for seed in _SEEDS:
        bare, taken = faulted_scene(Fault.NO_PLATE, seed), faulted_scene(Fault.FLAT_PANEL_FILE, seed)
        assert bare.scene.intensifier
        assert bare.scene.plate is None
        assert bare.intensifier_file
        assert taken.scene.plate is not None
        assert not taken.intensifier_file
        covered = faulted_scene(Fault.PLATE_COVERED, seed).scene.plate
        assert covered is not None
        assert covered.covered_to_mm is not None


@pytest.mark.parametrize("fault", Fault)
def test_same_seed_draws_the_same_scene(fault: Fault) -> None:
    one, again, other = (faulted_scene(fault, seed).scene for seed in (3, 3, 4))
    assert np.array_equal(one.guides[0].source_from_guide, again.guides[0].source_from_guide)
    assert one.exposure == again.exposure
    assert not np.array_equal(one.guides[0].source_from_guide, other.guides[0].source_from_guide)


def test_exposure_faults_change_the_exposure_alone() -> None:
    for seed in _SEEDS:
        assert faulted_scene(Fault.MOTION_BLUR, seed).scene.exposure.motion_px >= 2.0
        assert faulted_scene(Fault.LOW_DOSE, seed).scene.exposure.photons <= 3000.0
        assert faulted_scene(Fault.SATURATION, seed).scene.exposure.gain >= 1.2
        assert faulted_scene(Fault.COLLIMATED, seed).scene.exposure.collimator_px is not None
        crop = faulted_scene(Fault.CROPPED, seed).scene.exposure.crop_px
        assert crop not in (None, (0, 1023, 0, 1023))

"""Rendered images against their own truth, computed here by another way."""

import time
from dataclasses import replace

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter, map_coordinates

from simulator.carm.drawing import random_scene
from simulator.carm.guide import ALL_PARTS, Part
from simulator.carm.render import render
from simulator.carm.scene import PlacedGuide, Scene

_GROUPS = ["ii", "steep", "flat", "strong"]
_KEYS = [
    "image",
    "carm",
    "guide",
    "group",
    "source_to_image_distance_mm",
    "pixel_size_mm",
    "principal_point_ideal_px",
    "source_from_guide_mm",
    "target_ideal_px",
    "target_raw_px",
    "ideal_from_raw_px",
]


def _clean(scene: Scene, **changes) -> Scene:
    """Without patient, noise and plate, where single wires can be measured."""
    exposure = replace(scene.exposure, photons=1e9, bits=16, gamma=1.0)
    return replace(scene, body=None, plate=None, exposure=exposure, **changes)


def _with_parts(scene: Scene, *parts: Part) -> Scene:
    guide = scene.guides[0]
    return replace(scene, guides=(PlacedGuide(replace(guide.shape, parts=frozenset(parts)), guide.source_from_guide),))


def _raw_of(truth: dict, scene: Scene, point_in_guide: list[float]) -> np.ndarray:
    """By K [R t], from the numbers in the truth."""
    alpha = truth["source_to_image_distance_mm"] / truth["pixel_size_mm"]
    u0, v0 = truth["principal_point_ideal_px"]
    x, y, z = (np.array(truth["source_from_guide_mm"]) @ [*point_in_guide, 1.0])[:3]
    return scene.distortion.raw_from_ideal(np.array([alpha * x / z + u0, alpha * y / z + v0]))


@pytest.mark.parametrize("group", _GROUPS)
def test_bead_lies_where_the_truth_projects_it(group: str) -> None:
    scene = _with_parts(_clean(random_scene(11, group)), Part.BEAD)
    rendered = render(scene, 0)
    dark = rendered.pixels.max() - rendered.pixels.astype(float)
    u, v = _raw_of(rendered.truth, scene, [0.0, 45.0, -30.0])
    window = dark[round(v) - 12 : round(v) + 13, round(u) - 12 : round(u) + 13]
    rows, columns = np.mgrid[-12:13, -12:13]
    found = np.array([(window * columns).sum(), (window * rows).sum()]) / window.sum() + [round(u), round(v)]
    np.testing.assert_allclose(found, [u, v], atol=0.03)  # px; a ball's centroid is shifted by 0.003 px in perspective


@pytest.mark.parametrize(("part", "radius_mm", "z_mm"), [(Part.SMALL_RING, 20.0, 0.0), (Part.BIG_RING, 30.0, -60.0)])
def test_ring_runs_where_the_truth_projects_it(part: Part, radius_mm: float, z_mm: float) -> None:
    scene = _with_parts(_clean(random_scene(5, "steep")), part)
    rendered = render(scene, 0)
    intensity = rendered.pixels.astype(float)
    for turn in np.linspace(0.0, 2.0 * np.pi, 9):
        outward = np.array([np.cos(turn), np.sin(turn), 0.0])
        at, out = (
            _raw_of(rendered.truth, scene, (outward * r + [0.0, 0.0, z_mm]).tolist())
            for r in (radius_mm, radius_mm + 1)
        )
        along = np.arange(-8.0, 8.0, 0.1)
        places = at + along[:, None] * (out - at) / np.linalg.norm(out - at)
        dark = intensity.max() - map_coordinates(intensity, [places[:, 1], places[:, 0]], order=3)
        assert dark.max() > 0.2 * intensity.max()
        assert abs((dark * along).sum() / dark.sum()) < 0.1  # px; the tilt of a wire of 0.6 mm under perspective


@pytest.mark.parametrize("missing", [Part.SMALL_RING, Part.BIG_RING, Part.LINE, Part.BEAD])
def test_hidden_part_leaves_the_rest_as_it_is(missing: Part) -> None:
    scene = _clean(random_scene(2))
    whole, lacking = render(scene, 1).pixels, render(_with_parts(scene, *(ALL_PARTS - {missing})), 1).pixels
    changed = np.abs(whole.astype(float) - lacking) > 3000
    assert 50 < changed.sum() < 8000
    assert np.all(lacking[changed] > whole[changed])


def test_second_guide_adds_its_own_wires() -> None:
    scene = _clean(random_scene(2))
    pose = scene.guides[0].source_from_guide.copy()
    pose[0, 3] += 25.0
    double = replace(scene, guides=(*scene.guides, PlacedGuide(scene.guides[0].shape, pose)))
    counts = [
        np.count_nonzero((one > 0) & (one < 0.6 * 65535)) for one in (render(s, 1).pixels for s in (double, scene))
    ]
    assert counts[0] > 1.6 * counts[1]


@pytest.mark.parametrize("group", _GROUPS)
def test_truth_is_told_as_the_samples_tell_it(group: str) -> None:
    truth = render(random_scene(3, group), 3).truth
    assert list(truth) == _KEYS
    assert len(truth["ideal_from_raw_px"]) == 81
    assert truth["ideal_from_raw_px"][40][:2] == [511.5, 511.5]
    flat = group == "flat"
    assert truth["carm"] == ("carm-flat-panel.toml" if flat else "carm-intensifier.toml")
    assert (truth["target_raw_px"] == truth["target_ideal_px"]) is flat


def test_same_seed_gives_the_same_picture_and_another_seed_only_other_noise() -> None:
    scene = random_scene(4)
    first, again, other = (render(scene, seed).pixels.astype(float) for seed in (1, 1, 2))
    assert np.array_equal(first, again)
    assert not np.array_equal(first, other)
    assert np.abs(gaussian_filter(first - other, 8.0)).max() < 0.01 * first.max()


def test_intensifier_is_round_and_flat_panel_is_not() -> None:
    assert render(random_scene(1, "ii"), 0).pixels[:60, :60].max() == 0
    assert render(random_scene(1, "flat"), 0).pixels[:60, :60].min() > 0


def test_low_dose_is_grainier() -> None:
    scene = replace(random_scene(6), plate=None, guides=random_scene(6).guides)
    weak = replace(scene, exposure=replace(scene.exposure, photons=scene.exposure.photons / 100.0))

    def grain(one: Scene) -> float:
        pixels = render(one, 1).pixels[300:700, 300:700].astype(float)
        return float(np.std(np.diff(pixels, axis=1)))

    assert grain(weak) > 3.0 * grain(scene)


def test_gain_saturates_and_blades_darken() -> None:
    scene = random_scene(6)
    bright = replace(scene, exposure=replace(scene.exposure, gain=2.0))
    highest = 2**scene.exposure.bits - 1
    assert (render(bright, 1).pixels == highest).mean() > 0.05 > (render(scene, 1).pixels == highest).mean()
    narrow = replace(scene, exposure=replace(scene.exposure, collimator_px=(300.0, 700.0, 300.0, 700.0)))
    pixels = render(narrow, 1).pixels
    assert pixels[250:290, 400:600].mean() < 0.1 * pixels[310:690, 310:690].mean()


def test_crop_counts_pixels_from_its_own_corner() -> None:
    scene = random_scene(6)
    cropped = replace(scene, exposure=replace(scene.exposure, crop_px=(100, 923, 60, 983)))
    whole, part = render(scene, 1), render(cropped, 1)
    assert np.array_equal(part.pixels, whole.pixels[60:984, 100:924])
    shift = np.subtract(whole.truth["target_raw_px"], part.truth["target_raw_px"])
    np.testing.assert_allclose(shift, [100.0, 60.0])
    shift = np.subtract(whole.truth["ideal_from_raw_px"], part.truth["ideal_from_raw_px"])
    np.testing.assert_allclose(shift, [[100.0, 60.0, 100.0, 60.0]] * 81, atol=1e-3)
    shift = np.subtract(whole.truth["principal_point_ideal_px"], part.truth["principal_point_ideal_px"])
    np.testing.assert_allclose(shift, [100.0, 60.0])


def test_motion_smears_along_its_direction_only() -> None:
    scene = _with_parts(_clean(random_scene(2)), Part.BEAD)
    moved = replace(scene, exposure=replace(scene.exposure, motion_px=12.0, motion_rad=0.0))

    def spread(one: Scene) -> tuple[float, float]:
        pixels = render(one, 1).pixels.astype(float)
        pixels[pixels == 0] = pixels.max()
        dark = np.maximum(pixels.max() - pixels - 0.05 * pixels.max(), 0.0)
        rows, columns = np.nonzero(dark)
        return float(np.std(columns)), float(np.std(rows))

    (wide, high), (wide_before, high_before) = spread(moved), spread(scene)
    assert wide > 1.5 * wide_before
    assert high < 1.1 * high_before


def test_image_is_made_within_two_seconds_of_one_core() -> None:
    render(random_scene(1), 1)  # imports and caches
    started_s = time.process_time()
    render(random_scene(2), 1)
    assert time.process_time() - started_s < 2.0

"""The quick renderer against the full one, pixel by pixel."""

import time
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.carm import quick_body
from simulator.carm.drawing import random_scene
from simulator.carm.guide import ALL_PARTS, Part
from simulator.carm.plate import Plate
from simulator.carm.quick_render import render_quickly
from simulator.carm.render import render
from simulator.carm.scene import PlacedGuide, Scene
from simulator.carm.solids import Shape, Solid


def _differences(scene: Scene) -> NDArray[np.float64]:
    """Of the two images of a scene without noise, each in shares of the brightest."""
    exposure = replace(scene.exposure, photons=1e12, gamma=1.0, bits=16)
    clean = replace(scene, exposure=exposure)
    one, other = (draw(clean, 0).pixels.astype(float) for draw in (render, render_quickly))
    return np.abs(one - other) / 65535.0


def _with_parts(scene: Scene, parts: frozenset[Part]) -> Scene:
    guide = scene.guides[0]
    return replace(scene, guides=(PlacedGuide(replace(guide.shape, parts=parts), guide.source_from_guide),))


@pytest.mark.parametrize(("seed", "group"), [(1, "ii"), (2, "steep"), (3, "flat"), (4, "strong")])
def test_both_renderers_make_the_same_image(seed: int, group: str) -> None:
    apart = _differences(random_scene(seed, group))
    # the grain of a dose of 15,000 quanta is 0.008, a step of 8 bits 0.004
    assert apart.max() < 0.004
    assert apart.mean() < 1e-4


@pytest.mark.parametrize("part", [Part.SMALL_RING, Part.BIG_RING, Part.LINE, Part.BEAD])
def test_a_missing_part_is_missing_in_both(part: Part) -> None:
    scene = replace(random_scene(5, "flat"), body=None)
    assert _differences(_with_parts(scene, ALL_PARTS - {part})).max() < 0.003


def test_half_covered_plate_is_covered_in_both() -> None:
    scene = replace(random_scene(6), body=None, plate=Plate(covered_to_mm=12.0))
    # a ball at the cover's edge is cut at another part of a pixel
    assert np.sort(_differences(scene), axis=None)[-200] < 0.003


def test_wide_guide_out_of_the_field_disturbs_neither() -> None:
    scene = replace(random_scene(7), body=None)
    guide = scene.guides[0]
    pose = guide.source_from_guide.copy()
    pose[0, 3] += 90.0
    assert _differences(replace(scene, guides=(PlacedGuide(guide.shape, pose),))).max() < 0.003


def test_same_seed_draws_the_same_noise_in_both() -> None:
    scene = random_scene(8)
    one, other = (draw(scene, 3).pixels.astype(float) for draw in (render, render_quickly))
    assert np.abs(one - other).max() <= 2**scene.exposure.bits // 100


def test_quick_image_takes_three_quarters_of_the_full_ones_time_at_most() -> None:
    scene = random_scene(9)
    times_s = {}
    for draw in (render_quickly, render):
        draw(scene, 0)  # caches
        times_s[draw] = min(_seconds(draw, scene) for _ in range(2))
    assert times_s[render_quickly] < times_s[render] * 0.75


def _seconds(draw, scene: Scene) -> float:
    started_s = time.process_time()
    draw(scene, 0)
    return time.process_time() - started_s


def test_a_ray_along_a_cylinders_axis_meets_its_whole_length_as_its_neighbours_do() -> None:
    solid = Solid(Shape.CYLINDER, (0.0, 0.0, 700.0), (10.0, 10.0, 20.0), per_mm=0.02)
    x = np.array([[0.0, 1e-6, 1e-3, 0.1]], dtype=np.float32)
    chord_mm = quick_body._chord(solid, np.eye(4), x, np.zeros_like(x))
    np.testing.assert_allclose(chord_mm, [[40.0, 40.0, 40.0, 0.0]], rtol=1e-4)

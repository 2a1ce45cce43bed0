"""Ends of the line in images of a renderer that shares no code with their measurement; every true end is known."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.carm.camera import Camera
from simulator.carm.guide import ALL_PARTS, GuideShape, Part
from simulator.carm.quick_render import render_quickly
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from vision.bands import Shadows
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.line_ends import LineEnd, measure_line_ends
from vision.measuring import FAINTEST
from vision.projection import View, project

Array = NDArray[np.float64]

PIXEL_MM = 360.0 / 1024.0
BLUR_PX, DEPTH, BALL_RADIUS_PX = 1.1, 0.8, 1.0 / PIXEL_MM
FLAT = DistortionMap.identity(1024, 1024, PIXEL_MM)
V, U = np.indices((1024, 1024))


def absorption_of(view: View, shape: GuideShape, photons: float = 1e8) -> NDArray[np.float32]:
    """Of a guide alone."""
    intrinsics = view.intrinsics
    scene = Scene(
        camera=Camera(intrinsics.alpha_x_px * PIXEL_MM, PIXEL_MM, intrinsics.u0_px, intrinsics.v0_px),
        guides=(PlacedGuide(shape, view.source_from_guide),),
        target_ideal_px=(500.0, 500.0),
        intensifier=False,
        exposure=Exposure(photons=photons, gamma=1.0, blur_px=BLUR_PX, bits=16),
    )
    pixels = render_quickly(scene, 1).pixels
    return np.asarray(-np.log(np.maximum(pixels / 65535.0, 1e-4)), dtype=np.float32)


def ends_of(view: View, guide: Guide, values: NDArray[np.float32], balls: Array | None = None) -> dict[float, LineEnd]:
    """Ends that are told, by their place."""
    shadows = Shadows(DEPTH, BLUR_PX, np.zeros((0, 2)) if balls is None else balls, BALL_RADIUS_PX)
    return {end.x_mm: end for end in measure_line_ends(view, guide, FLAT, values, shadows)}


@pytest.fixture(scope="module")
def view(make_view: Callable[..., View]) -> View:
    """The line leans by 20 degrees against the detector, and its start is near the big ring."""
    return make_view(20.0, 90.0, 0.0)


def per_mm(view: View) -> float:
    """Pixels along the line for a millimetre of it, at its middle."""
    near, far = project(view, np.array([[45.5, 0.0, 0.0], [46.5, 0.0, 0.0]]))
    return float(np.linalg.norm(far - near))


@pytest.mark.parametrize("off_mm", [-0.6, 0.0, 0.35])
def test_ends_are_measured_outwards(off_mm: float, view: View, guide: Guide) -> None:
    shape = GuideShape(line_start_mm=26.0 - off_mm, line_end_mm=66.0 + off_mm)
    ends = ends_of(view, guide, absorption_of(view, shape))
    assert set(ends) == {26.0, 66.0}
    for end in ends.values():
        assert end.excess_px == pytest.approx(off_mm * per_mm(view), abs=0.25)  # the blur's fourth part
        assert end.amplitude == pytest.approx(DEPTH, rel=0.1)


def test_an_end_between_ring_and_balls_is_where_it_was(view: View, guide: Guide) -> None:
    values = absorption_of(view, GuideShape()).astype(np.float64)
    balls = np.add(project(view, np.array([[66.0, 0.0, 0.0]])), [[3.0, 1.0], [-8.0, 4.0]])
    for u, v in balls:
        values += 0.9 * np.sqrt(np.clip(1.0 - ((U - u) ** 2 + (V - v) ** 2) / BALL_RADIUS_PX**2, 0.0, None))
    found = ends_of(view, guide, values.astype(np.float32), balls)[66.0]
    assert abs(found.excess_px) < 2.0 * found.sd_px


@pytest.mark.parametrize("longer_mm", [5.0, -2.0])
def test_a_line_of_another_length_is_surely_off(longer_mm: float, view: View, guide: Guide) -> None:
    ends = ends_of(view, guide, absorption_of(view, GuideShape(line_end_mm=66.0 + longer_mm)))
    assert np.sign(longer_mm) * ends[66.0].excess_px > 4.0 * ends[66.0].sd_px


def test_a_line_that_is_not_there_has_faint_ends_or_none(view: View, guide: Guide) -> None:
    values = absorption_of(view, GuideShape(parts=ALL_PARTS - {Part.LINE}), photons=1e4)
    assert all(end.amplitude < FAINTEST * DEPTH for end in ends_of(view, guide, values).values())


def test_an_end_that_noise_hides_is_not_told(view: View, guide: Guide) -> None:
    values = absorption_of(view, GuideShape())
    noisy = values + np.random.default_rng(3).normal(0.0, 1.5, values.shape)
    assert ends_of(view, guide, noisy.astype(np.float32)) == {}


def test_ends_scatter_as_they_say(view: View, guide: Guide) -> None:
    shape = replace(GuideShape(), line_start_mm=26.0)
    values = absorption_of(view, shape)
    rng, deviations = np.random.default_rng(4), []
    for _ in range(30):
        waves = sum(
            0.05 * np.sin(U * np.cos(turn) / length + V * np.sin(turn) / length + phase)
            for turn, length, phase in zip(*rng.uniform((0.0, 3.0, 0.0), (6.3, 12.0, 6.3), (4, 3)).T, strict=True)
        )
        ends = ends_of(view, guide, (values + waves + rng.normal(0.0, 0.05, values.shape)).astype(np.float32))
        deviations += [end.excess_px / end.sd_px for end in ends.values()]
    assert len(deviations) > 40
    assert np.sqrt(np.mean(np.square(deviations))) < 1.2

"""Wires measured piece by piece in images of a renderer that shares no code with them; every true place is known."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.carm.camera import Camera
from simulator.carm.guide import GuideShape
from simulator.carm.plate import Plate
from simulator.carm.quick_render import render_quickly
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from vision.absorption import Absorption
from vision.bands import Shadows, cut_pieces
from vision.bead_centre import measure_bead
from vision.devices import CArm, Guide
from vision.distortion import DistortionMap, PlateFit, exact
from vision.measuring import Scene as MeasuredScene
from vision.measuring import measure
from vision.offsets import Offsets, measure_offsets
from vision.pieces import Pieces
from vision.priors import Priors
from vision.profiles import ProfileReader
from vision.projection import Intrinsics, View, project
from vision.refusal import Refusal, RefusalCode
from vision.wire_model import Wire

Array = NDArray[np.float64]

PIXEL_MM = 360.0 / 1024.0
BLUR_PX, DEPTH, BALL_RADIUS_PX = 1.1, 0.8, 1.0 / PIXEL_MM
FLAT: PlateFit = exact(DistortionMap.identity(1024, 1024, PIXEL_MM))


def scene_of(view: View, plate: Plate | None = None) -> Scene:
    """The guide alone in an exposure almost without noise."""
    intrinsics = view.intrinsics
    return Scene(
        camera=Camera(intrinsics.alpha_x_px * PIXEL_MM, PIXEL_MM, intrinsics.u0_px, intrinsics.v0_px),
        guides=(PlacedGuide(GuideShape(), view.source_from_guide),),
        target_ideal_px=(500.0, 500.0),
        plate=plate,
        intensifier=False,
        exposure=Exposure(photons=1e8, gamma=1.0, blur_px=BLUR_PX, bits=16),
    )


def absorption_of(scene: Scene) -> NDArray[np.float32]:
    """Minus the logarithm of its pixels."""
    pixels = render_quickly(scene, 1).pixels
    return np.asarray(-np.log(np.maximum(pixels / 65535.0, 1e-4)), dtype=np.float32)


def measured(
    view: View, guide: Guide, values: NDArray[np.float32], balls: Array | None = None
) -> tuple[Pieces, Offsets]:
    """Every piece's offset from a view."""
    shadows = Shadows(DEPTH, BLUR_PX, np.zeros((0, 2)) if balls is None else balls, BALL_RADIUS_PX)
    pieces = cut_pieces(view, guide, FLAT, values, shadows)
    return pieces, measure_offsets(pieces, DEPTH, BLUR_PX)


@pytest.fixture(scope="module")
def view() -> View:
    """Tilted by 20 degrees, so that the line crosses the big ring."""
    cosine, sine = np.cos(np.radians(20.0)), np.sin(np.radians(20.0))
    pose = np.eye(4)
    pose[:3, :3] = [[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]]
    pose[:3, 3] = (6.0, -9.0, 745.0)
    return View(Intrinsics(2844.4, 2844.4, 511.0, 512.5), pose)


@pytest.fixture(scope="module")
def values(view: View) -> NDArray[np.float32]:
    """Of the guide alone."""
    return absorption_of(scene_of(view))


def test_every_piece_lies_where_the_wire_was_rendered(view: View, guide: Guide, values: NDArray[np.float32]) -> None:
    pieces, offsets = measured(view, guide, values)
    assert {Wire(wire) for wire in pieces.samples.wire} == set(Wire)
    # the housing's wall, hidden in nothing here, and crossings leave some hundredths of a pixel in places
    assert float(np.median(np.abs(offsets.offset_px))) < 0.01
    assert float(np.percentile(np.abs(offsets.offset_px), 95.0)) < 0.05


def test_a_view_that_is_off_is_told_by_how_much(view: View, guide: Guide, values: NDArray[np.float32]) -> None:
    shift = np.array([0.35, -0.2])
    off = replace(view.intrinsics, u0_px=view.intrinsics.u0_px + shift[0], v0_px=view.intrinsics.v0_px + shift[1])
    pieces, offsets = measured(View(off, view.source_from_guide), guide, values)
    wanted = -pieces.samples.normals @ shift
    assert float(np.median(np.abs(offsets.offset_px - wanted))) < 0.02


def test_balls_below_a_wire_do_not_move_it(view: View, guide: Guide) -> None:
    scene = scene_of(view, Plate())
    assert scene.plate is not None
    balls = scene.plate.balls_ideal_px(scene.camera)
    pieces, offsets = measured(view, guide, absorption_of(scene), balls)
    distance = np.min(np.linalg.norm(pieces.samples.points[:, None] - balls[None], axis=2), axis=1)
    near = distance < 6.0
    assert near.sum() > 20
    assert float(np.sqrt(np.mean(offsets.offset_px[near] ** 2))) < 0.06
    _, unaware = measured(view, guide, absorption_of(scene))
    assert float(np.sqrt(np.mean(unaware.offset_px[near] ** 2))) > 0.2


def test_rough_ground_below_a_stretch_of_a_ring_moves_it_little(
    view: View, guide: Guide, values: NDArray[np.float32]
) -> None:
    u, v = np.meshgrid(np.arange(1024.0), np.arange(1024.0))
    waves = 0.15 * np.sin(2.0 * np.pi * u / 18.0) * np.cos(2.0 * np.pi * v / 18.0) * (u < 400.0)
    pieces, offsets = measured(view, guide, values + waves.astype(np.float32))
    there = pieces.samples.points[:, 0] < 395.0
    assert there.sum() > 20
    # a ground held as smooth as the usual piece's leaves twice as much
    assert float(np.median(np.abs(offsets.offset_px[there]))) < 0.02


def test_noise_is_told_by_the_standard_deviation(view: View, guide: Guide, values: NDArray[np.float32]) -> None:
    clean = measured(view, guide, values)[1].offset_px
    noise = np.random.default_rng(3).normal(0.0, 0.03, values.shape).astype(np.float32)
    noisy = measured(view, guide, values + noise)[1]
    deviations = (noisy.offset_px - clean) / noisy.sd_px
    # pixels behind the wire are weighted down as if they were noisier, so white noise comes out a little smaller
    assert 0.6 < 1.4826 * float(np.median(np.abs(deviations))) < 1.3


def test_the_beads_centre_is_measured_from_half_a_pixel_away(
    view: View, guide: Guide, values: NDArray[np.float32]
) -> None:
    assert guide.bead is not None
    truth = project(view, np.array([guide.bead.position_mm]))[0]
    shadows = Shadows(DEPTH, BLUR_PX, np.zeros((0, 2)), BALL_RADIUS_PX)
    bead = measure_bead(view, guide, truth + np.array([0.4, -0.3]), FLAT.map, values, shadows, 1.5)
    assert bead.centre_px == pytest.approx(truth, abs=0.03)
    assert bead.sd_px < 0.1


def test_wires_that_are_covered_everywhere_are_not_found(
    view: View, guide: Guide, flat_panel: CArm, values: NDArray[np.float32]
) -> None:
    reader = ProfileReader(Absorption(values, np.ones(values.shape, dtype=bool)), FLAT.map, 4.5)
    u, v = np.meshgrid(np.arange(0.0, 1024.0, 5.0), np.arange(0.0, 1024.0, 5.0))
    balls = np.column_stack((u.ravel(), v.ravel(), np.full(u.size, BALL_RADIUS_PX)))
    priors = Priors.of(flat_panel, guide, view.intrinsics)
    scene = MeasuredScene(guide, priors, FLAT, reader, values, balls, BLUR_PX)
    refusal = measure(view, guide, scene, DEPTH)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.NO_GUIDE_FOUND

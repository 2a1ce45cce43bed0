"""Ridge points and profiles: where a drawn wire is, below the pixel, on tissue and under distortion."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from vision.absorption import Absorption, absorption
from vision.curvature import Curvature
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.profiles import ProfileReader
from vision.projection import View
from vision.wire_model import Wire, sample_wires
from vision.wires import Ridge, ridge_points, wire_curvature_sigma_px
from vision.xray import XrayImage

Array = NDArray[np.float64]

SIDE = 1024
WIRE_PX = 4.6
CREST_SD_PX = 1.6
FLAT = DistortionMap.identity(SIDE, SIDE, 0.3515625)
NO_BALLS = np.zeros((0, 3))
U, V = (axis.astype(np.float64) for axis in np.meshgrid(np.arange(SIDE), np.arange(SIDE)))


def drawn(segments: list[tuple[Array, Array]], slope: float = 0.0, noise: float = 0.02, seed: int = 0) -> Absorption:
    """Straight wires from end to end on a sloping, noisy ground."""
    values = slope * U / 100.0 + np.random.default_rng(seed).normal(0.0, noise, (SIDE, SIDE))
    for start, end in segments:
        along = (end - start) / np.linalg.norm(end - start)
        across_px = -(U - start[0]) * along[1] + (V - start[1]) * along[0]
        at_px = (U - start[0]) * along[0] + (V - start[1]) * along[1]
        length_px = np.linalg.norm(end - start)
        inside = 0.25 * (1.0 + np.tanh(1.4 * at_px)) * (1.0 + np.tanh(1.4 * (length_px - at_px)))
        values += 0.6 * inside * np.exp(-(across_px**2) / (2.0 * CREST_SD_PX**2))
    return Absorption(values.astype(np.float32), np.ones((SIDE, SIDE), dtype=bool))


START, END = np.array([200.3, 310.8]), np.array([760.1, 640.2])
NORMAL = np.array([-(END - START)[1], (END - START)[0]]) / np.linalg.norm(END - START)


def ridge_of(image: Absorption, balls: Array = NO_BALLS) -> Ridge:
    """The image's ridges, nothing bent."""
    return ridge_points(Curvature.of(image, wire_curvature_sigma_px(WIRE_PX)), FLAT, balls)


def test_ridge_points_lie_on_the_wire_and_know_its_direction() -> None:
    ridge = ridge_of(drawn([(START, END)]))
    along = np.clip((ridge.points - START) @ (END - START) / np.sum((END - START) ** 2), 0.0, 1.0)
    distance = np.linalg.norm(ridge.points - START - along[:, None] * (END - START), axis=1)
    on = distance < 3.0
    # a clean wire gives a crest in almost every column of cells that it crosses
    assert on.sum() > 0.9 * np.abs(END - START).max() / ridge.spacing_px
    assert np.quantile(distance[on], 0.95) < 0.2  # px; the blurred ends bend off
    assert np.median(np.abs(ridge.normals[on] @ NORMAL)) > 0.999


def test_balls_are_no_ridges() -> None:
    balls = np.array([[*(START + share * (END - START)), 12.0] for share in (0.3, 0.6)])
    ridge = ridge_of(drawn([(START, END)]), balls)
    assert min(np.linalg.norm(ridge.points - ball[:2], axis=1).min() for ball in balls) > 12.0


def test_an_empty_image_has_no_ridges_worth_a_ring() -> None:
    even = Absorption(np.zeros((SIDE, SIDE), np.float32), np.ones((SIDE, SIDE), dtype=bool))
    assert len(ridge_of(even).points) == 0


@pytest.mark.parametrize("slope", [0.0, 3.0, -3.0])
@pytest.mark.parametrize("off_px", [0.0, 1.7, -2.6])
def test_profiles_measure_the_offset_whatever_the_ground(slope: float, off_px: float) -> None:
    reader = ProfileReader(drawn([(START, END)], slope), FLAT, WIRE_PX)
    places = START + np.linspace(0.1, 0.9, 300)[:, None] * (END - START) - off_px * NORMAL
    profiles = reader.read(places, np.broadcast_to(NORMAL, places.shape))
    assert np.mean(profiles.offset_px) == pytest.approx(off_px, abs=0.02)
    assert np.std(profiles.offset_px) < 0.15
    assert np.median(profiles.amplitude) == pytest.approx(0.6, rel=0.1)


def test_samples_are_a_pixel_apart_with_normals_across(make_view: Callable[..., View], guide: Guide) -> None:
    samples = sample_wires(make_view(25.0, 70.0, 10.0), guide)
    for wire in Wire:
        points, normals = samples.points[samples.wire == wire], samples.normals[samples.wire == wire]
        steps = np.diff(points, axis=0)
        lengths = np.linalg.norm(steps, axis=1)
        assert lengths.max() < 1.4
        assert np.abs((steps * normals[:-1]).sum(axis=1) / lengths).max() < 0.05
        assert np.allclose(np.linalg.norm(normals, axis=1), 1.0)


def test_absorption_adds_up_and_the_field_is_where_the_beam_is() -> None:
    pixels = np.where(np.hypot(U - 500.0, V - 500.0) < 400.0, 0.5, 0.0).astype(np.float32)
    pixels[480:500, 480:500] = 0.0  # dense metal inside the field is no border
    seen = absorption(XrayImage(pixels, 8, "0" * 64))
    assert seen.field_area_px == pytest.approx(np.pi * 400.0**2, rel=0.02)  # 4 px of its edge
    assert seen.inside[490, 490]
    darker = absorption(XrayImage(pixels * np.float32(0.8), 8, "0" * 64))
    bright = (slice(300, 320), slice(300, 320))
    assert np.allclose(darker.values[bright] - seen.values[bright], -np.log(0.8), atol=1e-5)

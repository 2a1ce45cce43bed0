"""Handedness by the bead: its place, its mirror place, neither, and what else may darken a patch (H05)."""

from collections.abc import Callable

import numpy as np
import pytest
from numpy.typing import NDArray

from vision.absorption import Absorption
from vision.bead import BeadEvidence, Crossing, locate_bead
from vision.devices import Bead, Guide
from vision.distortion import DistortionMap
from vision.profiles import ProfileReader
from vision.projection import View, project
from vision.refusal import Refusal, RefusalCode

Array = NDArray[np.float64]

SIDE = 1024
PER_MM = 0.5  # absorption of a wire for each mm of its diameter
NOTHING = Crossing(np.zeros((0, 2)), np.zeros((0, 3)))
U, V = (axis.astype(np.float64) for axis in np.meshgrid(np.arange(SIDE), np.arange(SIDE)))


def ground(seed: int = 0) -> Array:
    """Uneven tissue and noise."""
    return 0.5 * np.sin(U / 70.0) * np.cos(V / 110.0) + np.random.default_rng(seed).normal(0.0, 0.03, (SIDE, SIDE))


def ball(centre: Array, radius_px: float, height: float) -> Array:
    """The shadow of a sphere."""
    squared = ((U - centre[0]) ** 2 + (V - centre[1]) ** 2) / radius_px**2
    return height * np.sqrt(np.clip(1.0 - squared, 0.0, None))


def wire(through: Array, angle_rad: float, height: float) -> tuple[Array, Array]:
    """The shadow of a straight wire and samples (n, 2) along it."""
    across = -(U - through[0]) * np.sin(angle_rad) + (V - through[1]) * np.cos(angle_rad)
    steps = np.arange(-40.0, 41.0)
    along = through + steps[:, None] * (np.cos(angle_rad), np.sin(angle_rad))
    return height * np.exp(-(across**2) / (2.0 * 1.6**2)), along


@pytest.fixture
def view(make_view: Callable[..., View]) -> View:
    """A usual view."""
    return make_view(12.0, 50.0, 130.0)


@pytest.fixture
def bead(guide: Guide) -> Bead:
    """The reference guide's."""
    assert guide.bead is not None
    return guide.bead


@pytest.fixture
def places(view: View, bead: Bead) -> tuple[Array, Array]:
    """The bead's place and its mirror place, corrected px."""
    x, y, z = bead.position_mm
    own, mirror = project(view, np.array([[x, y, z], [x, -y, z]]))
    return own, mirror


@pytest.fixture
def radius_px(view: View, bead: Bead) -> float:
    """Of the bead's shadow."""
    pose = view.source_from_guide
    depth_mm = (pose[:3, :3] @ np.array(bead.position_mm) + pose[:3, 3])[2]
    return float(view.intrinsics.alpha_x_px * bead.diameter_mm / 2.0 / depth_mm)


@pytest.fixture
def look(view: View, bead: Bead) -> Callable[..., BeadEvidence | Refusal]:
    """The bead's evidence in absorption values."""

    def run(values: Array, crossing: Crossing = NOTHING) -> BeadEvidence | Refusal:
        image = Absorption(values.astype(np.float32), np.ones((SIDE, SIDE), dtype=bool))
        reader = ProfileReader(image, DistortionMap.identity(SIDE, SIDE, 0.35), 4.6)
        return locate_bead(view, bead, PER_MM, reader, crossing)

    return run


def test_a_bead_at_its_place_is_found_below_the_pixel(
    places: tuple[Array, Array], radius_px: float, look: Callable[..., BeadEvidence | Refusal]
) -> None:
    centre = places[0] + (1.3, -0.7)
    evidence = look(ground() + ball(centre, radius_px, 3.0 * PER_MM))
    assert isinstance(evidence, BeadEvidence), evidence
    assert np.linalg.norm(evidence.centre_px - centre) < 0.2
    assert evidence.amplitude == pytest.approx(1.0, abs=0.25)


@pytest.mark.hazard("H05")
def test_a_bead_at_its_mirror_place_means_a_mirrored_image(
    places: tuple[Array, Array], radius_px: float, look: Callable[..., BeadEvidence | Refusal]
) -> None:
    refusal = look(ground() + ball(places[1], radius_px, 3.0 * PER_MM))
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.MIRRORED


def test_no_bead_is_missed_rather_than_guessed(look: Callable[..., BeadEvidence | Refusal]) -> None:
    for seed in range(5):
        refusal = look(ground(seed))
        assert isinstance(refusal, Refusal)
        assert refusal.code is RefusalCode.BEAD_MISSING


@pytest.mark.hazard("H05")
def test_beads_at_both_places_prove_nothing(
    places: tuple[Array, Array], radius_px: float, look: Callable[..., BeadEvidence | Refusal]
) -> None:
    both = sum(ball(place, radius_px, 3.0 * PER_MM) for place in places)
    refusal = look(ground() + both)
    assert isinstance(refusal, Refusal)
    assert refusal.code is RefusalCode.BEAD_MISSING


@pytest.mark.parametrize("angle_rad", [0.0, 0.7, 2.0])
@pytest.mark.parametrize("off_px", [0.0, 3.0])
def test_a_wire_across_the_bead_hides_it_not(
    angle_rad: float,
    off_px: float,
    places: tuple[Array, Array],
    radius_px: float,
    look: Callable[..., BeadEvidence | Refusal],
) -> None:
    shadow, samples = wire(places[0] + off_px, angle_rad, 1.2 * PER_MM)
    evidence = look(ground() + shadow + ball(places[0], radius_px, 3.0 * PER_MM), Crossing(samples, np.zeros((0, 3))))
    assert isinstance(evidence, BeadEvidence), evidence
    assert np.linalg.norm(evidence.centre_px - places[0]) < 0.4


def test_a_wire_or_a_ball_of_the_plate_is_not_taken_for_the_bead(
    places: tuple[Array, Array], look: Callable[..., BeadEvidence | Refusal]
) -> None:
    shadow, samples = wire(places[0], 0.4, 1.2 * PER_MM)
    plate_ball = np.array([[*places[0], 2.9]])
    for values, crossing in (
        (shadow, Crossing(samples, np.zeros((0, 3)))),
        (ball(places[0], 2.9, 0.8), Crossing(np.zeros((0, 2)), plate_ball)),
    ):
        refusal = look(ground() + values, crossing)
        assert isinstance(refusal, Refusal)
        assert refusal.code is RefusalCode.BEAD_MISSING

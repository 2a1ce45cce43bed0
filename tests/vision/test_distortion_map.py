"""The distortion map: what a warp of known form becomes, with hidden balls, false ones and beyond the field."""

import json

import numpy as np
import pytest
from numpy.typing import NDArray

from vision.distortion import DistortionMap, PlateFit
from vision.plate_fit import fit

Array = NDArray[np.float64]

ROWS = COLUMNS = 1024
MIDDLE = 511.5
SPACING_MM, SPACING_PX = 15.0, 43.0


def warp(ideal: Array) -> Array:
    """Raw pixels of ideal ones: pincushion, twist and a wave, some 15 px at the border."""
    x, y = ((ideal - MIDDLE) / MIDDLE).T
    squared = x * x + y * y
    return ideal + np.column_stack(
        (12.0 * x * squared - 6.0 * y * squared + 0.5 * np.sin(5.0 * y), 12.0 * y * squared + 6.0 * x * squared)
    )


def balls(noise_px: float = 0.0, seed: int = 0) -> tuple[Array, Array]:
    """Raw pixels and places of all balls in the round field."""
    i, j = np.meshgrid(np.arange(-12, 13), np.arange(-12, 13))
    places = np.column_stack((i.ravel(), j.ravel())).astype(np.float64)
    turn = 0.03
    axes = SPACING_PX * np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    raw = warp(places @ axes + MIDDLE + (3.0, -8.0))
    seen = np.hypot(*(raw - MIDDLE).T) < 505.0
    raw = raw[seen] + np.random.default_rng(seed).normal(0.0, noise_px, (int(seen.sum()), 2))
    return raw, places[seen]


def fitted(noise_px: float = 0.0, seed: int = 0) -> PlateFit:
    """The fit to those balls."""
    return fit(*balls(noise_px, seed), ROWS, COLUMNS, SPACING_MM)


def off_a_similarity(points: Array, wanted: Array) -> Array:
    """Distances (n,) that the best similarity between both sets leaves."""
    a, b = (p - p.mean(axis=0) for p in (points, wanted))
    left, singular, right = np.linalg.svd(b.T @ a)
    return np.linalg.norm(a @ (left @ right).T * (singular.sum() / (a**2).sum()) - b, axis=1)


def field(reach_px: float = 400.0) -> Array:
    """Ideal pixels all over the middle of the image."""
    u, v = np.meshgrid(np.linspace(-reach_px, reach_px, 15), np.linspace(-reach_px, reach_px, 15))
    points = np.column_stack((u.ravel(), v.ravel()))
    return points[np.hypot(*points.T) < reach_px] + MIDDLE


def test_a_window_is_mapped_as_its_pixels_are() -> None:
    distortion = fitted().map
    u, v = np.meshgrid(300 + np.arange(9), 620 + np.arange(5))
    wanted = distortion.corrected_from_raw(np.column_stack((u.ravel(), v.ravel())))
    found = distortion.corrected_window(300, 620, 9, 5).reshape(2, -1).T
    assert found == pytest.approx(wanted, abs=1e-9)


def test_a_known_warp_is_undone_between_the_balls() -> None:
    corrected = fitted().map.corrected_from_raw(warp(field()))
    assert off_a_similarity(corrected, field()).max() < 0.02  # px: what degree 7 leaves of the wave


def test_the_pixel_size_is_that_of_the_mean_raw_pixel() -> None:
    raw, places = balls()
    mean_px = np.sqrt(((raw - raw.mean(axis=0)) ** 2).sum() / ((places - places.mean(axis=0)) ** 2).sum())
    assert fitted().map.pixel_size_mm == pytest.approx(SPACING_MM / mean_px, rel=2e-3)


def test_raw_and_corrected_are_inverse_to_one_another() -> None:
    distortion = fitted(0.05).map
    raw = warp(field(480.0))
    assert np.abs(distortion.raw_from_corrected(distortion.corrected_from_raw(raw)) - raw).max() < 1e-6


def test_the_inverse_stays_finite_far_outside_the_field() -> None:
    far = np.array([[-5000.0, 0.0], [1e6, 1e6], [1100.0, -200.0], [511.5, 1e9]])
    assert np.isfinite(fitted(0.1).map.raw_from_corrected(far)).all()


def test_false_balls_are_left_out_and_counted_out() -> None:
    raw, places = balls(0.05)
    wrong = np.arange(5, len(raw), 20)
    raw[wrong] += np.random.default_rng(3).choice((-4.0, 4.0), (len(wrong), 2))
    plate = fit(raw, places, ROWS, COLUMNS, SPACING_MM)
    # a good ball in some hundreds lies beyond 4 standard deviations by chance
    assert len(raw) - len(wrong) - 3 <= plate.map.balls <= len(raw) - len(wrong)
    assert off_a_similarity(plate.map.corrected_from_raw(warp(field())), field()).max() < 0.1
    assert plate.map.rms_px < 0.1


def test_the_covariance_is_the_spread_over_repeated_noise() -> None:
    points = warp(np.array([[400.0, 450.0], [700.0, 300.0], [511.0, 850.0]]))
    maps = [fitted(0.1, seed) for seed in range(60)]
    kept = [plate.map.corrected_from_raw(points) for plate in maps if plate.map.degree == maps[0].map.degree]
    spread = np.var(kept, axis=0).mean(axis=1)
    predicted = np.diag(maps[0].covariance_of(points))
    # 120 draws of a variance: 13 % sd; the corrected grid itself moves with the mean of the balls a little
    assert np.all(np.abs(np.log(spread / predicted)) < 0.6)


def test_a_flat_panel_has_the_identity() -> None:
    distortion = DistortionMap.identity(ROWS, COLUMNS, 0.35)
    points = np.array([[0.0, 0.0], [1e4, -3.0]])
    assert np.array_equal(distortion.corrected_from_raw(points), points)
    assert np.array_equal(distortion.raw_from_corrected(points), points)


def test_the_map_survives_json() -> None:
    distortion = fitted(0.05).map
    again = DistortionMap.from_json(json.loads(json.dumps(distortion.to_json())))
    points = warp(field())
    assert np.array_equal(again.corrected_from_raw(points), distortion.corrected_from_raw(points))
    assert (again.balls, again.rms_px, again.pixel_size_mm) == (
        distortion.balls,
        distortion.rms_px,
        distortion.pixel_size_mm,
    )


@pytest.mark.parametrize(
    "change", [{"degree": 3}, {"half_size_px": 0.0}, {"pixel_size_mm": -1.0}, {"coefficients_px": "no"}, {"rms_px": -1}]
)
def test_a_damaged_map_is_a_value_error(change: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"\A.+\Z"):
        DistortionMap.from_json(fitted().map.to_json() | change)

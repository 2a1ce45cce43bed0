"""Rings among clutter: two ellipses of ridge points, broken and crossed by others, and a false circle or two."""

import numpy as np
import pytest
from numpy.typing import NDArray

from vision.conics import Ellipse
from vision.detection import AxisRange, RingCandidate, ring_candidates
from vision.wires import Ridge

Array = NDArray[np.float64]

AXES = AxisRange(55.0, 190.0)
SPACING_PX = 2.0
SMALL = Ellipse((520.4, 480.7), (78.0, 70.5), 0.6)
BIG = Ellipse((548.2, 503.1), (122.0, 109.0), 0.7)


def around(ellipse: Ellipse, hidden_rad: float = 0.0, seed: int = 0, noise_px: float = 0.2) -> Ridge:
    """Ridge points along an ellipse, about one every other pixel, an arc of it hidden."""
    rng = np.random.default_rng(seed)
    t = np.linspace(0.0, 2.0 * np.pi - hidden_rad, int(5.5 * ellipse.semi_axes_px[0] / SPACING_PX), endpoint=False)
    a, b = ellipse.semi_axes_px
    c, s = np.cos(ellipse.angle_rad), np.sin(ellipse.angle_rad)
    turn = np.array([[c, s], [-s, c]])
    normals = np.column_stack((b * np.cos(t), a * np.sin(t))) @ turn
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    points = np.column_stack((a * np.cos(t), b * np.sin(t))) @ turn + ellipse.centre_px
    return Ridge(points + rng.normal(0.0, noise_px, (len(t), 1)) * normals, normals, SPACING_PX)


def clutter(count: int, seed: int = 1) -> Ridge:
    """Points and directions anywhere."""
    rng = np.random.default_rng(seed)
    angle = rng.uniform(0.0, np.pi, count)
    return Ridge(rng.uniform(0.0, 1023.0, (count, 2)), np.column_stack((np.cos(angle), np.sin(angle))), SPACING_PX)


def together(*ridges: Ridge) -> Ridge:
    """All points."""
    points, normals = (np.vstack([getattr(ridge, name) for ridge in ridges]) for name in ("points", "normals"))
    return Ridge(points, normals, SPACING_PX)


def best_match(candidates: list[RingCandidate], wanted: Ellipse) -> float:
    """Greatest difference of centre and axes of the candidate most like an ellipse, px."""
    return min(
        max(np.abs(np.subtract(c.ellipse.centre_px + c.ellipse.semi_axes_px, wanted.centre_px + wanted.semi_axes_px)))
        for c in candidates
    )


@pytest.mark.parametrize("hidden_deg", [0.0, 90.0])
@pytest.mark.parametrize("others", [0, 3000])
def test_both_rings_are_found_though_broken_and_in_clutter(hidden_deg: float, others: int) -> None:
    ridge = together(around(SMALL, np.radians(hidden_deg)), around(BIG, np.radians(hidden_deg), 2), clutter(others))
    candidates = ring_candidates(ridge, AXES)
    for ring in (SMALL, BIG):
        assert best_match(candidates, ring) < 1.0  # px: enough to start from


def test_support_tells_how_much_of_a_ring_is_seen() -> None:
    whole, broken = (ring_candidates(around(BIG, hidden), AXES)[0].support for hidden in (0.0, np.pi / 2.0))
    assert whole > 0.97
    assert broken == pytest.approx(0.75, abs=0.05)


def test_circles_of_another_size_give_no_whole_ring() -> None:
    big, small = Ellipse((500.0, 500.0), (260.0, 255.0), 0.0), Ellipse((500.0, 500.0), (30.0, 29.0), 0.0)
    # arcs of the big one look like ellipses of a ring's size for less than half their way round
    assert all(c.support < 0.5 for c in ring_candidates(together(around(big), around(small)), AXES))


def test_whole_rings_come_first_and_each_once() -> None:
    candidates = ring_candidates(together(around(SMALL), around(BIG)), AXES)
    for ring in (SMALL, BIG):
        assert best_match(candidates[:2], ring) < 1.0
        assert best_match(candidates[2:], ring) > 5.0


@pytest.mark.parametrize("count", [0, 10, 5000])
def test_clutter_alone_holds_no_ring(count: int) -> None:
    assert ring_candidates(clutter(count), AXES) == []

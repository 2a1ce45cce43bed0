"""An aim, and an evaluated error, that hang on one word of the device files are refused, each at its own target."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from vision import trust
from vision.alignment import goal
from vision.evaluation import Evaluation, evaluate_registration
from vision.projection import View, project
from vision.refusal import Refusal, RefusalCode
from vision.registered import FittedDimensions, PixelSpace, Registration
from vision.strain import Strain
from vision.targeting import Targeting, target

TURN = np.eye(13)[4]  # rad, about the source's x axis
LONGER = np.array(
    [2844.0, 2844.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 750.0, 0.0, 0.0, 0.0]
)  # the whole C-arm, relative


@pytest.fixture
def strained(monkeypatch: pytest.MonkeyPatch) -> Callable[[NDArray[np.float64]], None]:
    """Without trust in the separation the solution makes this step."""

    def step(freed: NDArray[np.float64]) -> None:
        tests = Strain(("separation",), np.zeros(1), 0.0, 1, freed[None])
        monkeypatch.setattr(trust, "strain", lambda *_: tests)

    return step


@pytest.fixture
def aligned(vector_view: View, guide: Any, make_registration: Callable[..., Registration]) -> Registration:
    """Of a guide whose axis holds the source."""
    guide_from_goal, _ = goal(vector_view, project(vector_view, np.zeros((1, 3)))[0])
    registration = make_registration(View(vector_view.intrinsics, vector_view.source_from_guide @ guide_from_goal))
    sizes_mm = np.array([guide.small_ring_radius_mm, guide.big_ring_radius_mm, guide.separation_mm])
    return replace(registration, dimensions=FittedDimensions(sizes_mm, np.eye(3, 13, 10)))


def at(registration: Registration, x_mm: float) -> tuple[float, float]:
    """The corrected pixel of a place beside the small ring's centre."""
    u, v = project(registration.view(), np.array([[x_mm, 0.0, 0.0]]))[0].tolist()
    return u, v


@pytest.mark.parametrize(("turn_deg", "passes"), [(0.19, True), (0.21, False)])
def test_an_error_that_hangs_on_one_word_is_not_told(
    turn_deg: float, passes: bool, aligned: Registration, strained: Callable[[NDArray[np.float64]], None]
) -> None:
    """A turn of 0.2 deg moves the axis by half a millimetre at the target, 140 mm below."""
    strained(np.radians(turn_deg) * TURN)
    aimed = target(aligned, at(aligned, 0.0), PixelSpace.CORRECTED)
    evaluated = evaluate_registration(aligned, at(aligned, 0.0), PixelSpace.CORRECTED)
    assert isinstance(aimed, Targeting) is passes
    assert isinstance(evaluated, Evaluation) is passes
    for refusal in (aimed, evaluated):
        assert passes or (isinstance(refusal, Refusal) and refusal.code is RefusalCode.GUIDE_MISMATCH)


def test_an_aligned_guide_tells_its_error_though_aims_to_the_side_hang(
    aligned: Registration, strained: Callable[[NDArray[np.float64]], None]
) -> None:
    strained(0.3 * LONGER)
    assert isinstance(target(aligned, at(aligned, 40.0), PixelSpace.CORRECTED), Refusal)
    assert isinstance(evaluate_registration(aligned, at(aligned, 0.0), PixelSpace.CORRECTED), Evaluation)


def test_the_target_s_own_depth_counts(aligned: Registration, strained: Callable[[NDArray[np.float64]], None]) -> None:
    strained(np.radians(0.19) * TURN)
    assert isinstance(evaluate_registration(aligned, at(aligned, 0.0), PixelSpace.CORRECTED, 80.0), Evaluation)
    assert isinstance(evaluate_registration(aligned, at(aligned, 0.0), PixelSpace.CORRECTED, 160.0), Refusal)

"""A count that went a place aside is mended; a lattice that is whole is left as it came."""

import numpy as np
import pytest
from numpy.typing import NDArray

from vision.lattice_parts import mended

Array = NDArray[np.float64]

SPACING_PX = 43.0
STEPS = SPACING_PX * np.eye(2)
FAULT_FROM = 4  # places of the columns from here on, below the middle, are counted one too low


def bent_lattice() -> tuple[Array, NDArray[np.intp]]:
    """Raw pixels (n, 2) and places (n, 2) in a round field; a row of balls beside the fault is not found."""
    places = np.argwhere(np.ones((23, 23))) - 11
    places = places[np.hypot(*places.T) < 11.5]
    places = places[~((places[:, 0] >= FAULT_FROM) & (places[:, 1] == 0))]
    flat = SPACING_PX * places
    return flat * (1.0 + 0.08 * (flat**2).sum(axis=1, keepdims=True) / 490.0**2), places


def dislocated(places: NDArray[np.intp]) -> NDArray[np.bool_]:
    return np.asarray((places[:, 0] >= FAULT_FROM) & (places[:, 1] > 0))


def test_a_block_counted_a_place_off_is_told_anew_by_the_others() -> None:
    raw, places = bent_lattice()
    off = dislocated(places)
    assert off.sum() > 40
    stays, told = mended(raw, places - off[:, None] * (0, 1), STEPS)
    assert stays.all()
    assert (told == places).all()


def test_a_spot_that_led_the_count_aside_is_left_out() -> None:
    """It lies between places, where the block's count begins."""
    raw, places = bent_lattice()
    spot = SPACING_PX * np.array([[FAULT_FROM + 0.05, 0.4]])
    counted = np.vstack((places - dislocated(places)[:, None] * (0, 1), [[FAULT_FROM, -1]]))
    clash = (counted[:-1] == counted[-1]).all(axis=1)
    stays, told = mended(np.vstack((raw[~clash], spot)), np.vstack((counted[:-1][~clash], counted[-1:])), STEPS)
    assert stays[:-1].all()
    assert not stays[-1]
    assert (told[:-1] == places[~clash]).all()


def test_of_two_balls_told_to_one_place_the_nearer_stays() -> None:
    raw, places = bent_lattice()
    beside = raw[dislocated(places)][:1] + np.array([0.1 * SPACING_PX, 0.0])
    counted = np.vstack((places - dislocated(places)[:, None] * (0, 1), [[FAULT_FROM, 40]]))
    stays, _ = mended(np.vstack((raw, beside)), counted, STEPS)
    assert stays[:-1].all()
    assert not stays[-1]


@pytest.mark.parametrize("hidden", [0, 200])
def test_a_whole_lattice_is_left_as_it_came(hidden: int) -> None:
    raw, places = bent_lattice()
    seen = np.random.default_rng(3).permutation(len(raw))[hidden:]
    stays, told = mended(raw[seen], places[seen], STEPS)
    assert stays.all()
    assert (told == places[seen]).all()

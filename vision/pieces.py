"""A wire's pixels piece by piece: the unknowns' effects on them, laid out so that all pieces are solved at once."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.wire_model import WireSamples

Array = NDArray[np.float64]

GROUND = slice(2, 8)  # of a piece's unknowns


@dataclass(frozen=True, slots=True, eq=False)
class Pieces:
    """Pixels by piece: (s, p) each, padded with nothing of weight 0; p is the number of pixels of the fullest piece.

    Attributes
    ----------
    samples : WireSamples
        (s,): the pieces' middles.
    design : Array
        (s, 10, p): the unknowns' effects: shadow, its shift, six of the ground, balls and bead, other wires.
    values, weight : Array
        (s, p): absorption, and the pixels' worth.
    reach_px : Array
        (s,): half width of the band.
    """

    samples: WireSamples
    design: Array
    values: Array
    weight: Array
    reach_px: Array

    @classmethod
    def of(cls, samples: WireSamples, reach_px: Array, piece: NDArray[np.intp], rows: Array) -> "Pieces":
        """Of pixels and their pieces (n,).

        Parameters
        ----------
        samples, reach_px
            (s,), as above.
        piece : NDArray[np.intp]
            (n,): in which each pixel lies.
        rows : Array
            (8, n): the shadow's height and its derivative by the shift; distances across and along, in units of the
            reach; what other wires add, what balls and bead add; absorption; worth.
        """
        height, derivative, across, along, others, crossing, values, weight = rows
        square, there = across * across, np.ones_like(across)
        ground = there, across, along, across * along, square, square * across
        laid_out = _laid_out(piece, len(samples.along), (height, derivative, *ground, crossing, others, values, weight))
        return cls(samples, laid_out[:, :-2], laid_out[:, -2], laid_out[:, -1], reach_px)


def _laid_out(piece: NDArray[np.intp], count: int, rows: Sequence[Array]) -> Array:
    """k rows (n,) of pixels by their pieces, all as long as the longest: (s, k, p), zeros where no pixel is."""
    order = np.argsort(piece.astype(np.uint16), kind="stable")  # by digits, since the numbers are short
    sizes = np.bincount(piece, minlength=count)
    longest = int(sizes.max(initial=1))
    place = np.empty_like(piece)
    place[order] = np.arange(len(piece)) - np.repeat(np.cumsum(sizes) - sizes, sizes)
    laid_out = np.zeros(count * len(rows) * longest)
    place += piece * (len(rows) * longest)
    for row in rows:
        laid_out[place] = row
        place += longest
    return laid_out.reshape(count, len(rows), longest)

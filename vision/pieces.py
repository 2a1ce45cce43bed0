"""A wire's pixels piece by piece: the unknowns' effects on them, laid out so that all pieces are solved at once."""

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
        height, derivative, across, along, others, crossing, values, weight, there = _padded(
            piece, len(samples.along), rows
        )
        ground = there, across, along, across * along, across**2, across**3
        return cls(samples, np.stack((height, derivative, *ground, crossing, others), axis=1), values, weight, reach_px)


def _padded(piece: NDArray[np.intp], count: int, rows: Array) -> Array:
    """Rows (k, n) of pixels by their pieces, all as long as the longest: (k + 1, s, p), the last 1 where a pixel is."""
    order = np.argsort(piece, kind="stable")
    sizes = np.bincount(piece, minlength=count)
    longest = int(sizes.max(initial=1))
    slot = np.arange(len(piece)) + np.repeat(longest * np.arange(count) - np.cumsum(sizes) + sizes, sizes)
    padded = np.zeros((len(rows) + 1, count * longest))
    padded[:-1, slot], padded[-1, slot] = rows[:, order], 1.0
    return padded.reshape(len(padded), count, longest)

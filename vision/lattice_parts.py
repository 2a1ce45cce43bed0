"""A plate's lattice without dislocations: balls that were counted a place off, told anew by the others.

A spot between the balls, where wires cross for one, may lead the count a place aside, and what is counted from there on
is off by that place. Within a meshful of four balls this shows, since one of its sides is too long: the greatest part
of the lattice that hangs together by whole meshes is right, and tells the places of all other balls.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from vision import legendre

Array = NDArray[np.float64]
Places = NDArray[np.intp]

_SIDE_WITHIN = 0.3  # of the spacing: sides of a mesh by distortion; where a count went aside one is off by all of it
_TOLD_WITHIN = 0.2  # of the spacing: how far a ball may lie from where the others tell it
_DEGREE = 3  # of the map that tells: it follows a strong distortion to a tenth of the spacing, and beyond the balls too
_LEAST_TELLING = 40  # balls: four for each of its terms


def mended(raw: Array, places: Places, steps: Array) -> tuple[NDArray[np.bool_], Places]:
    """Which balls stay, and their places.

    Parameters
    ----------
    raw : Array
        (n, 2), raw pixels.
    places : Places
        (n, 2), as counted.
    steps : Array
        (2, 2): both steps of the lattice, px.

    Returns
    -------
    tuple
        (n,) and (n, 2): as they came where nothing is broken; balls that lie beside every place, or at one that is
        taken, are left out.
    """
    part = _parts(raw, places, steps)
    sure = part == np.argmax(np.bincount(part))
    if sure.all() or sure.sum() < _LEAST_TELLING:
        return np.ones(len(raw), dtype=bool), places
    middle, half = raw.mean(axis=0), np.ptp(raw, axis=0).max() / 2.0
    terms = legendre.terms((raw - middle) / half, _DEGREE)
    told = terms @ np.linalg.lstsq(terms[sure], places[sure].astype(np.float64), rcond=None)[0]
    anew = np.where(sure[:, None], places, np.rint(told).astype(np.intp))
    if (anew == places).all():
        return np.ones(len(raw), dtype=bool), places
    off = np.where(sure, 0.0, np.abs(told - anew).max(axis=1))
    first = np.argsort(off, kind="stable")
    alone = np.zeros(len(raw), dtype=bool)
    alone[first[np.unique(anew[first], axis=0, return_index=True)[1]]] = True
    return alone & (off < _TOLD_WITHIN), anew


def _parts(raw: Array, places: Places, steps: Array) -> NDArray[np.intp]:
    """Of which part (n,) each ball is: parts hang together by whole meshes."""
    at = places - places.min(axis=0)
    board = np.full(at.max(axis=0) + 1, -1, dtype=np.intp)
    board[tuple(at.T)] = np.arange(len(raw))
    within_px = _SIDE_WITHIN * float(np.hypot(*steps[0]))
    along = _good_sides(raw, board[:-1], board[1:], steps[0], within_px)
    across = _good_sides(raw, board[:, :-1], board[:, 1:], steps[1], within_px)
    whole = along[:, :-1] & along[:, 1:] & across[:-1] & across[1:]
    corner = board[:-1, :-1][whole]
    others = [corners[whole] for corners in (board[1:, :-1], board[:-1, 1:], board[1:, 1:])]
    links = np.tile(corner, len(others)), np.concatenate(others)
    graph = coo_array((np.ones(len(links[0])), links), shape=(len(raw), len(raw)))
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


def _good_sides(raw: Array, one: Places, next_: Places, step: Array, within_px: float) -> NDArray[np.bool_]:
    """Which neighbouring places both hold balls about a step apart."""
    apart_px = np.linalg.norm(raw[next_] - raw[one] - step, axis=-1)
    return np.asarray((one >= 0) & (next_ >= 0) & (apart_px < within_px))

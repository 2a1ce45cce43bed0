"""The balls of the correction plate: found below the pixel and indexed on their lattice."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from vision.absorption import Absorption
from vision.curvature import Curvature
from vision.devices import Plate
from vision.lattice_parts import mended
from vision.refusal import Refusal, RefusalCode
from vision.spots import fit_spots

Array = NDArray[np.float64]

LEAST_BALLS = 150  # four for each term of a polynomial of degree 7
MOST_CHANCE_BALLS = LEAST_BALLS // 2  # spots of bone and instruments are found on a lattice by the dozen at most
LEAST_FIELD_SHARE = 0.55  # of the lattice places inside the field that hold a ball
_CONTRAST_SD = 6.0  # of the noise of the blob measure
_MOST_CANDIDATES = 4000
_USUAL_DIAMETER_MM = 2.0
_USUAL_SPACINGS_MM = (9.0, 15.0, 25.0)  # each with a quarter to either side
_SPACING_WITHIN = 0.25  # relative, of the lattice's neighbours around the file's scale: distortion and SID
_STEP_WITHIN = 0.2  # of the spacing: how far a ball may lie from where its neighbours predict it
_SEED_CANDIDATES = 600
_MOST_ASKED = 100  # differences that are asked how many are like them: of a lattice's, which are mostly alike
_ALIKE = 0.3  # of the spacing: neighbours' differences by distortion
_NEIGHBOURS = np.array([(1, 0), (-1, 0), (0, 1), (0, -1)])


@dataclass(frozen=True, slots=True, eq=False)
class Lattice:
    """Balls found: raw pixels (n, 2) and their whole-numbered places on the plate (n, 2)."""

    raw: Array
    places: Array


def find_lattice(absorption: Absorption, plate: Plate, pixel_size_mm: float) -> Lattice | Refusal:
    """Find the plate's balls.

    Parameters
    ----------
    absorption : Absorption
        The image.
    plate : Plate
        Spacing and diameter of the balls, mm.
    pixel_size_mm : float
        By the C-arm file.

    Returns
    -------
    Lattice or Refusal
        `plate_missing` where no lattice is seen, `plate_too_sparse` where too little of it is.
    """
    radius_px, spacing_px = plate.ball_diameter_mm / 2.0 / pixel_size_mm, plate.ball_spacing_mm / pixel_size_mm
    candidates = _candidates(absorption, radius_px)
    steps = _lattice_steps(candidates[:_SEED_CANDIDATES], spacing_px)
    if steps is None:
        message = "no lattice of the plate's balls near the C-arm file's scale: balls in it"
        return Refusal(RefusalCode.PLATE_MISSING, message, 0.0, LEAST_BALLS)
    members, places = _grown(candidates, steps)
    if len(members) < LEAST_BALLS:
        code = RefusalCode.PLATE_TOO_SPARSE if len(members) > LEAST_BALLS // 5 else RefusalCode.PLATE_MISSING
        return Refusal(code, "balls of the correction plate found on one lattice", len(members), LEAST_BALLS)
    share = len(members) * spacing_px**2 / absorption.field_area_px
    if share < LEAST_FIELD_SHARE:
        message = "share of the field in which the correction plate is seen"
        return Refusal(RefusalCode.PLATE_TOO_SPARSE, message, share, LEAST_FIELD_SHARE)
    right, places = mended(candidates[members], places, steps)
    members, places = members[right], places[right]
    spots = fit_spots(absorption.values, candidates[members], radius_px)
    return Lattice(spots.raw[spots.settled], places[spots.settled].astype(np.float64))


def ball_spots(absorption: Absorption, plate: Plate, pixel_size_mm: float) -> Array:
    """Dark spots (n, 2) of the balls' size, raw pixels, from among which a lattice is looked for.

    The arguments are those of `find_lattice`.
    """
    return _candidates(absorption, plate.ball_diameter_mm / 2.0 / pixel_size_mm)[:_SEED_CANDIDATES]


def balls_on_any_lattice(absorption: Absorption, pixel_size_mm: float) -> int:
    """Balls on the largest lattice of a usual plate, where the C-arm file knows of none.

    Only as many of the strongest spots are looked at as a lattice would have balls: among more, chance finds some.
    """
    candidates = _candidates(absorption, _USUAL_DIAMETER_MM / 2.0 / pixel_size_mm)
    most = 0
    if len(candidates) < MOST_CHANCE_BALLS:
        return most
    for spacing_px in np.array(_USUAL_SPACINGS_MM) / pixel_size_mm:
        strongest = candidates[: round(absorption.field_area_px / spacing_px**2)]
        steps = _lattice_steps(strongest, spacing_px)
        if steps is not None:
            most = max(most, len(_grown(strongest, steps)[0]))
    return most


def _candidates(absorption: Absorption, radius_px: float) -> Array:
    """Dark spots (n, 2) of the balls' size, raw pixels, the strongest first.

    The measure is the lesser curvature of the smoothed image: wires, which bend in one direction only, have none.
    """
    curvature = Curvature.of(absorption, radius_px / np.sqrt(2.0))
    measure = curvature.lesser
    window = 2 * max(1, round(2.0 * radius_px / curvature.cell_px)) + 1
    peaks = measure == cv2.dilate(measure, np.ones((window, window), np.uint8))
    peaks &= (measure > _CONTRAST_SD * curvature.noise_of(measure)) & curvature.inside
    rows, columns = np.divmod(np.flatnonzero(peaks), peaks.shape[1])
    order = np.argsort(-measure[rows, columns])[:_MOST_CANDIDATES]
    return curvature.raw_from_cells(_summits(measure, rows[order], columns[order]))


def _summits(measure: NDArray[np.float32], rows: NDArray[np.intp], columns: NDArray[np.intp]) -> Array:
    """Where parabolas through each peak and its neighbours along u and v have their summits (n, 2), cells."""
    last_row, last_column = measure.shape[0] - 1, measure.shape[1] - 1
    peak = measure[rows, columns]
    summits = []
    for place, before, after in (
        (columns, measure[rows, np.maximum(columns - 1, 0)], measure[rows, np.minimum(columns + 1, last_column)]),
        (rows, measure[np.maximum(rows - 1, 0), columns], measure[np.minimum(rows + 1, last_row), columns]),
    ):
        bend = np.maximum(2.0 * peak - before - after, np.finfo(np.float32).tiny)
        summits.append(place + np.clip((after - before) / (2.0 * bend), -0.5, 0.5))
    return np.column_stack(summits).astype(np.float64)


def _lattice_steps(strongest: Array, spacing_px: float) -> Array | None:
    """Both steps (2, 2) of the lattice, px: the commonest difference of neighbours, and it a quarter turn on."""
    if len(strongest) < 4:
        return None
    pairs = KDTree(strongest).query_pairs(spacing_px * (1.0 + _SPACING_WITHIN), output_type="ndarray")
    differences = strongest[pairs[:, 1]] - strongest[pairs[:, 0]]
    lengths = np.hypot(*differences.T)
    near = lengths > spacing_px * (1.0 - _SPACING_WITHIN)
    # the fourth power makes the four directions of a square lattice one
    turns = np.exp(4j * np.arctan2(differences[near, 1], differences[near, 0])) * lengths[near]
    if len(turns) < LEAST_BALLS // 5:
        return None
    asked = turns[:: len(turns) // _MOST_ASKED + 1]
    alike = np.abs(turns - asked[:, None]) < _ALIKE * spacing_px
    chosen = turns[alike[int(np.argmax(alike.sum(axis=1)))]]
    mean = np.mean(chosen)
    angle, length = np.angle(mean) / 4.0, np.mean(np.abs(chosen))
    step = length * np.array([np.cos(angle), np.sin(angle)])
    return np.array([step, [-step[1], step[0]]])


def _grown(candidates: Array, steps: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of the candidates on the largest lattice grown from any of several seeds, and their places."""
    tree = KDTree(candidates)
    centre = candidates[: LEAST_BALLS * 2].mean(axis=0)
    seeds = np.argsort(np.hypot(*(candidates[:_SEED_CANDIDATES] - centre).T))[::7]
    best = np.zeros(0, dtype=np.intp), np.zeros((0, 2), dtype=np.intp)
    for seed in seeds[:40]:
        found = _grow(candidates, tree, steps, int(seed))
        if len(found[0]) > len(best[0]):
            best = found
        if len(best[0]) > len(candidates[:_SEED_CANDIDATES]) // 2:
            break
    return best


def _grow(candidates: Array, tree: KDTree, steps: Array, seed: int) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Lattice places reachable from a seed, ring by ring; each ball is predicted from the two before it in its row.

    The board holds the candidate of each place, -1 for none; it is as wide as the candidates can reach.
    """
    within = _STEP_WITHIN * float(np.hypot(*steps[0]))
    middle = 3 + int(np.ptp(candidates, axis=0).max() / (np.hypot(*steps[0]) - within))
    board = np.full((2 * middle + 1, 2 * middle + 1), -1, dtype=np.intp)
    board[middle, middle] = seed
    free = np.ones(len(candidates), dtype=bool)
    free[seed] = False
    front = np.array([[middle, middle]])
    while len(front):
        ahead, way = _empty_beside(front, board)
        at, before = (board[tuple((ahead - times * way).T)] for times in (1, 2))
        step = np.where(before[:, None] >= 0, candidates[at] - candidates[before], way @ steps)
        distance, index = tree.query(candidates[at] + step, distance_upper_bound=within)
        reached = np.nonzero(distance < within)[0]
        reached = reached[free[index[reached]]]
        # one ball for each place and one place for each ball: of several predictions the nearest wins
        reached = _nearest_of_each(index, reached, distance)
        reached = _nearest_of_each(ahead @ (len(board), 1), reached, distance)
        front = ahead[reached]
        board[tuple(front.T)] = index[reached]
        free[index[reached]] = False
    places = np.argwhere(board >= 0)
    return board[tuple(places.T)], places - middle


def _empty_beside(front: NDArray[np.intp], board: NDArray[np.intp]) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """The empty places (n, 2) beside those of a front, not at the very edge, and the ways (n, 2) that led there."""
    way = np.tile(_NEIGHBOURS, (len(front), 1))
    ahead = np.repeat(front, len(_NEIGHBOURS), axis=0) + way
    ahead, way = (places[((ahead >= 2) & (ahead < len(board) - 2)).all(axis=1)] for places in (ahead, way))
    empty = board[tuple(ahead.T)] < 0
    return ahead[empty], way[empty]


def _nearest_of_each(key: NDArray[np.intp], chosen: NDArray[np.intp], distance: Array) -> NDArray[np.intp]:
    """Of the chosen rows that share a key, the one of least distance."""
    chosen = chosen[np.argsort(distance[chosen], kind="stable")]
    return chosen[np.unique(key[chosen], return_index=True)[1]]

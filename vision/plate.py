"""The balls of the correction plate: found below the pixel and indexed on their lattice."""

from collections import deque
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from vision.absorption import Absorption
from vision.devices import Plate
from vision.refusal import Refusal, RefusalCode
from vision.spots import fit_spots

Array = NDArray[np.float64]

LEAST_BALLS = 150  # four for each term of a polynomial of degree 7
LEAST_FIELD_SHARE = 0.55  # of the lattice places inside the field that hold a ball
_CONTRAST_SD = 6.0  # of the noise of the blob measure
_MOST_CANDIDATES = 4000
_SPACING_WITHIN = 0.25  # relative, of the lattice's neighbours around the file's scale: distortion and SID
_STEP_WITHIN = 0.2  # of the spacing: how far a ball may lie from where its neighbours predict it
_SEED_CANDIDATES = 600
_NEIGHBOURS = ((1, 0), (-1, 0), (0, 1), (0, -1))


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
    spots = fit_spots(absorption.values, candidates[members], radius_px)
    return Lattice(spots.raw[spots.settled], places[spots.settled].astype(np.float64))


def _candidates(absorption: Absorption, radius_px: float) -> Array:
    """Dark spots (n, 2) of the balls' size, raw pixels, the strongest first.

    The measure is the lesser curvature of the smoothed image: wires, which bend in one direction only, have none.
    """
    curvature = absorption.lesser_curvature(radius_px / np.sqrt(2.0))
    window = 2 * round(2.0 * radius_px) + 1
    peaks = (curvature == cv2.dilate(curvature, np.ones((window, window), np.uint8))) & absorption.inside
    noise = 1.4826 * float(np.median(np.abs(curvature[absorption.inside])))
    rows, columns = np.nonzero(peaks & (curvature > _CONTRAST_SD * noise))
    order = np.argsort(-curvature[rows, columns])[:_MOST_CANDIDATES]
    return np.column_stack((columns[order], rows[order])).astype(np.float64)


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
    votes = KDTree(np.column_stack((turns.real, turns.imag)))
    counts = votes.query_ball_point(votes.data, 0.3 * spacing_px, return_length=True)
    chosen = turns[votes.query_ball_point(votes.data[int(np.argmax(counts))], 0.3 * spacing_px)]
    mean = np.mean(chosen)
    angle, length = np.angle(mean) / 4.0, np.mean(np.abs(chosen))
    step = length * np.array([np.cos(angle), np.sin(angle)])
    return np.array([step, [-step[1], step[0]]])


def _grown(candidates: Array, steps: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Indices of the candidates on the largest lattice grown from any of several seeds, and their places."""
    tree = KDTree(candidates)
    centre = candidates[: LEAST_BALLS * 2].mean(axis=0)
    seeds = np.argsort(np.hypot(*(candidates[:_SEED_CANDIDATES] - centre).T))[::7]
    best: dict[tuple[int, int], int] = {}
    for seed in seeds[:40]:
        found = _grow(candidates, tree, steps, int(seed))
        if len(found) > len(best):
            best = found
        if len(best) > len(candidates[:_SEED_CANDIDATES]) // 2:
            break
    members = np.fromiter(best.values(), dtype=np.intp, count=len(best))
    return members, np.array(list(best), dtype=np.intp).reshape(-1, 2)


def _grow(candidates: Array, tree: KDTree, steps: Array, seed: int) -> dict[tuple[int, int], int]:
    """Lattice places reachable from a seed, each new ball predicted from the two before it in its row."""
    found, taken = {(0, 0): seed}, {seed}
    queue = deque([(0, 0)])
    within = _STEP_WITHIN * float(np.hypot(*steps[0]))
    while queue:
        place = queue.popleft()
        for way in _NEIGHBOURS:
            ahead, behind = (place[0] + way[0], place[1] + way[1]), (place[0] - way[0], place[1] - way[1])
            if ahead in found:
                continue
            here = candidates[found[place]]
            step = here - candidates[found[behind]] if behind in found else np.array(way) @ steps
            distance, index = tree.query(here + step)
            if distance < within and index not in taken:
                found[ahead] = int(index)
                taken.add(int(index))
                queue.append(ahead)
    return found

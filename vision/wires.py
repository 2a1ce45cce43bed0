"""Ridge points: where the absorption has the crest of a thin wire, to a fraction of a cell."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from vision.curvature import Curvature
from vision.distortion import DistortionMap

Array = NDArray[np.float64]

_CONTRAST_SD = 4.0  # of the spread of the ridge measure, most of which is anatomy, not noise
_CREST_WITHIN_CELLS = 0.6  # of the cell whose Taylor expansion finds it
_MOST_POINTS = 6_000
_ALONG_TO_ACROSS = 0.5  # greatest curvature along a wire, relative to that across it


@dataclass(frozen=True, slots=True, eq=False)
class Ridge:
    """Crest points of thin dark wires in corrected pixels, a spacing apart: places (n, 2) and unit normals (n, 2)."""

    points: Array
    normals: Array
    spacing_px: float

    def beyond(self, places: Array, within_px: float) -> "Ridge":
        """The points that lie farther than so many pixels from all places (n, 2)."""
        tree = KDTree(places, balanced_tree=False, compact_nodes=False)  # sooner built
        distance_px, _ = tree.query(self.points, distance_upper_bound=within_px)
        away = ~(distance_px <= within_px)
        return Ridge(self.points[away], self.normals[away], self.spacing_px)


def wire_curvature_sigma_px(wire_px: float) -> float:
    """Smoothing that shows wires of about `wire_px` width best: Steger's least is half of it."""
    return wire_px / float(np.sqrt(3.0))


def ridge_points(curvature: Curvature, distortion: DistortionMap, balls: Array) -> Ridge:
    """Ridge points, those at the plate's balls left out.

    Parameters
    ----------
    curvature : Curvature
        Of the image at the wires' scale.
    distortion : DistortionMap
        Raw -> corrected.
    balls : Array
        (n, 3): raw pixel and radius in px of what is no wire.

    Returns
    -------
    Ridge
        Corrected pixels, the strongest 6,000 at most.

    Notes
    -----
    Steger's detector: the crest is where the derivative along the direction of greatest curvature vanishes.
    """
    strong = (curvature.greater > _CONTRAST_SD * curvature.noise_of(curvature.greater)) & curvature.inside
    cell = np.flatnonzero(strong)
    rows, columns = np.divmod(cell, strong.shape[1])
    across, uu, uv, vv = (part.take(cell) for part in (curvature.greater, curvature.uu, curvature.uv, curvature.vv))
    angle = 0.5 * np.arctan2(2.0 * uv, uu - vv)
    normal_u, normal_v = np.cos(angle), np.sin(angle)
    along_u, along_v = curvature.slopes(rows, columns)
    shift = (normal_u * along_u + normal_v * along_v) / across * np.float32(curvature.sigma_cells**2)
    crest = np.maximum(np.abs(shift * normal_u), np.abs(shift * normal_v)) < _CREST_WITHIN_CELLS
    crest &= np.abs(curvature.lesser.take(cell)) < _ALONG_TO_ACROSS * across
    normals = np.column_stack((normal_u, normal_v))[crest].astype(np.float64)
    cells = np.column_stack((columns, rows))[crest] + shift[crest, None] * normals
    raw = curvature.raw_from_cells(cells)
    kept = np.nonzero(_apart_from(raw, balls))[0]
    if len(kept) > _MOST_POINTS:
        kept = kept[np.argpartition(-across[crest][kept], _MOST_POINTS)[:_MOST_POINTS]]
    return _corrected(raw[kept], normals[kept], distortion, float(curvature.cell_px))


def _apart_from(points: Array, balls: Array) -> NDArray[np.bool_]:
    if not len(balls) or not len(points):
        return np.ones(len(points), dtype=bool)
    distance, index = KDTree(balls[:, :2]).query(points, distance_upper_bound=float(balls[:, 2].max()))
    near = index < len(balls)
    return np.asarray(~near | (distance > balls[np.where(near, index, 0), 2]))


def _corrected(raw: Array, normals: Array, distortion: DistortionMap, spacing_px: float) -> Ridge:
    """Points and normals carried into corrected pixels; normals go by the inverse transpose of the derivative."""
    corrected, ((a, b), (c, d)) = distortion.corrected_from_raw(raw), np.moveaxis(distortion.jacobian(raw), 0, 2)
    # up to the determinant, which only scales them
    carried = np.column_stack((d * normals[:, 0] - c * normals[:, 1], a * normals[:, 1] - b * normals[:, 0]))
    return Ridge(corrected, carried / np.linalg.norm(carried, axis=1, keepdims=True), spacing_px)

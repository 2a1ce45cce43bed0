"""Ridge points: where the absorption has the crest of a thin wire, below the pixel."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from vision.absorption import Absorption
from vision.distortion import DistortionMap

Array = NDArray[np.float64]

_CONTRAST_SD = 4.0  # of the spread of the ridge measure, most of which is anatomy, not noise
_CREST_WITHIN_PX = 0.6  # of the pixel whose Taylor expansion finds it
_MOST_POINTS = 12_000
_ALONG_TO_ACROSS = 0.5  # greatest curvature along a wire, relative to that across it


@dataclass(frozen=True, slots=True, eq=False)
class Ridge:
    """Crest points of thin dark wires in corrected pixels: places (n, 2) and unit normals (n, 2)."""

    points: Array
    normals: Array


def ridge_points(absorption: Absorption, distortion: DistortionMap, wire_px: float, balls: Array) -> Ridge:
    """Ridge points of wires of about `wire_px` width, those at the plate's balls left out.

    Parameters
    ----------
    absorption : Absorption
        The image.
    distortion : DistortionMap
        Raw -> corrected.
    wire_px : float
        Width of a wire's shadow.
    balls : Array
        (n, 3): raw pixel and radius in px of what is no wire.

    Returns
    -------
    Ridge
        Corrected pixels, the strongest 12,000 at most.

    Notes
    -----
    Steger's detector: the crest is where the derivative along the direction of greatest curvature vanishes.
    """
    sigma_px = max(1.0, wire_px / np.sqrt(3.0))
    uu, uv, vv = absorption.curvatures(sigma_px)
    mean, spread = (uu + vv) / 2.0, np.sqrt((uu - vv) ** 2 / 4.0 + uv**2)
    across, along = mean + spread, mean - spread
    noise = 1.4826 * float(np.median(np.abs(across[absorption.inside])))
    strong = absorption.inside & (across > _CONTRAST_SD * noise) & (np.abs(along) < _ALONG_TO_ACROSS * across)
    rows, columns = np.nonzero(strong)
    angle = 0.5 * np.arctan2(2.0 * uv[rows, columns], uu[rows, columns] - vv[rows, columns])
    normals = np.column_stack((np.cos(angle), np.sin(angle))).astype(np.float64)
    along_u, along_v = absorption.slopes(sigma_px)
    slope = normals[:, 0] * along_u[rows, columns] + normals[:, 1] * along_v[rows, columns]
    shift = slope / across[rows, columns] * sigma_px**2
    crest = (np.abs(shift[:, None] * normals) < _CREST_WITHIN_PX).all(axis=1)
    raw = (np.column_stack((columns, rows)) + shift[:, None] * normals)[crest]
    kept = np.nonzero(_apart_from(raw, balls))[0]
    strength = across[rows, columns][crest][kept]
    kept = kept[np.argsort(-strength)[:_MOST_POINTS]]
    return _corrected(raw[kept], normals[crest][kept], distortion)


def _apart_from(points: Array, balls: Array) -> NDArray[np.bool_]:
    if not len(balls) or not len(points):
        return np.ones(len(points), dtype=bool)
    distance, index = KDTree(balls[:, :2]).query(points)
    return np.asarray(distance > balls[index, 2])


def _corrected(raw: Array, normals: Array, distortion: DistortionMap) -> Ridge:
    """Points and normals carried into corrected pixels; normals go by the inverse transpose of the derivative."""
    carried = np.linalg.solve(np.swapaxes(distortion.jacobian(raw), 1, 2), normals[:, :, None])[:, :, 0]
    return Ridge(distortion.corrected_from_raw(raw), carried / np.linalg.norm(carried, axis=1, keepdims=True))

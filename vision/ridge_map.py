"""Ridge points laid out on a grid, so that the one near any place is looked up, not searched for."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from vision.ellipse_forms import around, fitted, gradients
from vision.wires import Ridge

Array = NDArray[np.float64]

_REACH = 3  # spacings around each ridge point in which it is found
_MARGIN = _REACH + 2  # spacings around all points; beyond it none is near
_LINKED_WITHIN = 4.5  # spacings between neighbours on one ridge, which may go on behind a ball of the plate
_BESIDE, _BENT = 0.6, 0.12  # of a spacing and of their distance: how far the next point may lie beside a tangent
_BENT_WITHIN = 0.94  # cosine of the angle between neighbours' normals: 20 deg
_LEAST_FOLLOWERS = 12  # places around an ellipse that a refit rests on: twice its parameters


class RidgeMap:
    """Which ridge point is near a place, and how well ellipses agree with the ridges that they pass."""

    def __init__(self, ridge: Ridge) -> None:
        self._ridge = ridge
        self._corner = ridge.points.min(axis=0) - _MARGIN * ridge.spacing_px
        cells = self._cells(ridge.points)
        self._last = cells.max(axis=0) + _MARGIN
        self._owner = np.full((self._last[1] + 1, self._last[0] + 1), -1, dtype=np.intp)
        for shift in _disc(_REACH):
            self._owner[cells[:, 1] + shift[1], cells[:, 0] + shift[0]] = np.arange(len(cells))

    def _cells(self, points: Array) -> NDArray[np.intp]:
        return np.asarray(((points - self._corner) / self._ridge.spacing_px).astype(np.intp))

    def _near(self, points: Array) -> NDArray[np.intp]:
        """Index (...) of a ridge point near each place (..., 2), corrected pixels; -1 where there is none."""
        cells = np.clip(self._cells(points), 0, self._last)
        return np.asarray(self._owner[cells[..., 1], cells[..., 0]])

    def _matches(self, forms: Array, samples: int, within: float, parallel: float) -> tuple[Array, NDArray[np.bool_]]:
        """For places around each form: the ridge point near it (h, s, 2), and whether it agrees with the ellipse."""
        offsets, normals = around(forms, samples)
        places = forms[:, None, :2] + offsets
        index = self._near(places)
        points, across = self._ridge.points[index], self._ridge.normals[index]
        agree = np.abs(((points - places) * across).sum(axis=2)) < within * self._ridge.spacing_px
        agree &= (index >= 0) & (np.abs((across * normals).sum(axis=2)) > parallel)
        return points, agree

    def support(self, forms: Array, samples: int, within: float, parallel: float) -> Array:
        """Share (h,) of places around each form (h, 5) where a ridge runs along it, `within` spacings away."""
        if not len(forms):
            return np.zeros(0)
        return np.asarray(self._matches(forms, samples, within, parallel)[1].mean(axis=1), dtype=np.float64)

    def refitted(self, forms: Array, samples: int, within: float, parallel: float) -> Array:
        """The forms (k, 5) fitted anew to the ridge points that they follow, those that follow too few left out."""
        if not len(forms):
            return forms
        points, agree = self._matches(forms, samples, within, parallel)
        enough = agree.sum(axis=1) >= _LEAST_FOLLOWERS
        return fitted(forms[enough], points[enough], agree[enough].astype(np.float64))

    def followers(self, form: Array, within: float, parallel: float) -> NDArray[np.bool_]:
        """Which ridge points follow an ellipse (5,): near it, by Sampson's distance, and in its direction."""
        offsets = self._ridge.points - form[:2]
        slope = gradients(form[None], offsets[None])[0]
        length = np.linalg.norm(slope, axis=1)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = np.abs((slope * offsets).sum(axis=1) / 2.0 - 1.0) / length
            along = np.abs((slope * self._ridge.normals).sum(axis=1)) / length
        return np.asarray((distance < within * self._ridge.spacing_px) & (along > parallel))

    def pieces(self) -> NDArray[np.intp]:
        """Number (n,) of the unbroken, smoothly bending piece of ridge that each point belongs to."""
        points, normals = self._ridge.points, self._ridge.normals
        pairs = KDTree(points).query_pairs(_LINKED_WITHIN * self._ridge.spacing_px, output_type="ndarray")
        step = points[pairs[:, 1]] - points[pairs[:, 0]]
        one, other = normals[pairs[:, 0]], normals[pairs[:, 1]]
        reach = _BESIDE * self._ridge.spacing_px + _BENT * np.linalg.norm(step, axis=1)
        linked = np.maximum(np.abs((step * one).sum(axis=1)), np.abs((step * other).sum(axis=1))) < reach
        first, second = pairs[linked & (np.abs((one * other).sum(axis=1)) > _BENT_WITHIN)].T
        links = coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(len(points), len(points)))
        return np.asarray(connected_components(links, directed=False)[1], dtype=np.intp)


def _disc(reach: int) -> NDArray[np.intp]:
    """Whole steps (n, 2) within a disc, the farthest first, so that the nearest is the last to claim a cell."""
    steps = np.array([(x, y) for x in range(-reach, reach + 1) for y in range(-reach, reach + 1)], dtype=np.intp)
    length = (steps**2).sum(axis=1)
    order = np.argsort(-length, kind="stable")
    return np.asarray(steps[order][length[order] <= reach * reach])

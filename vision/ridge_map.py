"""Ridge points laid out on a grid, so that the one near any place is looked up, not searched for."""

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from vision.ellipse_forms import around, dot, fitted, gradients, length
from vision.wires import Ridge

Array = NDArray[np.float64]

_REACH = 3  # spacings around each ridge point in which it is found
_MARGIN = _REACH + 2  # spacings around all points; beyond it none is near
_LINKED_WITHIN = 4.5  # spacings between neighbours on one ridge, which may go on behind a ball of the plate
_BESIDE, _BENT = 0.6, 0.12  # of a spacing and of their distance: how far the next point may lie beside a tangent
_BENT_WITHIN = 0.94  # cosine of the angle between neighbours' normals: 20 deg
_AT_ONCE = 1 << 15  # places looked up together: what a processor keeps near it
_LEAST_FOLLOWERS = 12  # places around an ellipse that a refit rests on: twice its parameters


class RidgeMap:
    """Which ridge point is near a place, and how well ellipses agree with the ridges that they pass."""

    def __init__(self, ridge: Ridge) -> None:
        self._ridge = ridge
        self._corner = ridge.points.min(axis=0) - _MARGIN * ridge.spacing_px
        column, row = self._cells(*ridge.points.T)
        self._last = int(column.max()) + _MARGIN, int(row.max()) + _MARGIN
        self._owner = np.full((self._last[1] + 1, self._last[0] + 1), -1, dtype=np.intp)
        shift_u, shift_v = _disc(_REACH).T[:, :, None]
        self._owner[row + shift_v, column + shift_u] = np.arange(len(row))
        self._points, self._normals = (np.ascontiguousarray(axes.T) for axes in (ridge.points, ridge.normals))

    def _cells(self, u: Array, v: Array) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
        """Column and row of places."""
        spacing_px = self._ridge.spacing_px
        column, row = (
            ((axis - low) / spacing_px).astype(np.intp) for axis, low in zip((u, v), self._corner, strict=True)
        )
        return column, row

    def _near(self, u: Array, v: Array) -> NDArray[np.intp]:
        """Index (...) of a ridge point near each place, corrected pixels; -1 where there is none."""
        column, row = self._cells(u, v)
        cell = np.clip(row, 0, self._last[1]) * self._owner.shape[1] + np.clip(column, 0, self._last[0])
        return self._owner.take(cell)

    def _matches(
        self, forms: Array, samples: int, within: float, parallel: float
    ) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """For places around each form: the ridge point near it (h, s), and whether that agrees with the ellipse."""
        (x, y), (along_u, along_v) = around(forms, samples)
        u, v = forms[:, :1] + x, forms[:, 1:2] + y
        index = self._near(u, v)
        across_u, across_v = (axis[index] for axis in self._normals)
        away = (self._points[0][index] - u) * across_u + (self._points[1][index] - v) * across_v
        agree = (index >= 0) & (np.abs(away) < within * self._ridge.spacing_px)
        agree &= np.abs(across_u * along_u + across_v * along_v) > parallel
        return index, agree

    def support(self, forms: Array, samples: int, within: float, parallel: float) -> Array:
        """Share (h,) of places around each form (h, 5) where a ridge runs along it, `within` spacings away."""
        some = np.array_split(forms, len(forms) * samples // _AT_ONCE + 1)
        return np.concatenate([self._matches(few, samples, within, parallel)[1].mean(axis=1) for few in some])

    def refitted(self, forms: Array, samples: int, within: float, parallel: float) -> Array:
        """The forms (k, 5) fitted anew to the ridge points that they follow, those that follow too few left out."""
        if not len(forms):
            return forms
        index, agree = self._matches(forms, samples, within, parallel)
        enough = agree.sum(axis=1) >= _LEAST_FOLLOWERS
        return fitted(forms[enough], self._ridge.points.take(index[enough], axis=0), agree[enough].astype(np.float64))

    def followers(self, form: Array, within: float, parallel: float) -> NDArray[np.bool_]:
        """Which ridge points follow an ellipse (5,): near it, by Sampson's distance, and in its direction."""
        offsets = self._points - form[:2, None]
        slope = gradients(form[:, None], offsets[:, :, None])[:, :, 0]
        steepness = length(slope)
        with np.errstate(divide="ignore", invalid="ignore"):
            distance = np.abs(dot(slope, offsets) / 2.0 - 1.0) / steepness
            along = np.abs(dot(slope, self._normals)) / steepness
        return np.asarray((distance < within * self._ridge.spacing_px) & (along > parallel))

    def pieces(self) -> NDArray[np.intp]:
        """Number (n,) of the unbroken, smoothly bending piece of ridge that each point belongs to."""
        points = self._ridge.points
        tree = KDTree(points, balanced_tree=False, compact_nodes=False)  # sooner built, and asked but once
        pairs = tree.query_pairs(_LINKED_WITHIN * self._ridge.spacing_px, output_type="ndarray").T
        here, there = (self._points.take(ends, axis=1) for ends in pairs)
        one, other = (self._normals.take(ends, axis=1) for ends in pairs)
        step = there - here
        reach = _BESIDE * self._ridge.spacing_px + _BENT * length(step)
        linked = np.maximum(np.abs(dot(step, one)), np.abs(dot(step, other))) < reach
        first, second = pairs[:, linked & (np.abs(dot(one, other)) > _BENT_WITHIN)]
        links = coo_array((np.ones(len(first), dtype=np.int8), (first, second)), shape=(len(points), len(points)))
        return np.asarray(connected_components(links, directed=False)[1], dtype=np.intp)


def _disc(reach: int) -> NDArray[np.intp]:
    """Whole steps (n, 2) within a disc, the farthest first, so that the nearest is the last to claim a cell."""
    steps = np.array([(x, y) for x in range(-reach, reach + 1) for y in range(-reach, reach + 1)], dtype=np.intp)
    length = (steps**2).sum(axis=1)
    order = np.argsort(-length, kind="stable")
    return np.asarray(steps[order][length[order] <= reach * reach])

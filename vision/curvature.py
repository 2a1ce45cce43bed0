"""How the smoothed absorption bends: what tells spots and wires from the ground they lie on.

Derivatives of an image that is smoothed anyway need no finer grid than the smoothing, so they are taken on cells of
about its width; everything that is found on cells is measured again on pixels.
"""

from dataclasses import dataclass
from functools import cached_property

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.absorption import Absorption

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

_EVERY = 5  # row and column whose cells make a median: some 10,000 of them
_SD_OF_MEDIAN = 1.4826  # standard deviations of a normal distribution in its median absolute value


@dataclass(frozen=True, eq=False)
class Curvature:
    """Second derivatives of minus the smoothed absorption, times its sigma squared: a dark spot is positive.

    Attributes
    ----------
    cell_px : int
        Side of a cell in raw pixels.
    sigma_cells : float
        Standard deviation of the smoothing, cells.
    smooth, uu, uv, vv : Array32
        (rows, columns) of cells: smoothed absorption and its derivatives.
    inside : NDArray[np.bool_]
        Cells in the field.
    """

    cell_px: int
    sigma_cells: float
    smooth: Array32
    uu: Array32
    uv: Array32
    vv: Array32
    inside: NDArray[np.bool_]

    @classmethod
    def of(cls, absorption: Absorption, sigma_px: float) -> "Curvature":
        """Of an image smoothed by `sigma_px` raw pixels, at least one cell."""
        cell_px = max(1, int(sigma_px))
        sigma = max(1.0, sigma_px / cell_px)
        rows, columns = (side // cell_px for side in absorption.values.shape)
        pixels = absorption.values[: rows * cell_px, : columns * cell_px]
        cells = cv2.resize(pixels, (columns, rows), interpolation=cv2.INTER_AREA)
        smooth = cv2.GaussianBlur(cells, (0, 0), sigma, borderType=cv2.BORDER_REPLICATE)
        uu, uv, vv = (
            cv2.Sobel(smooth, cv2.CV_32F, *order, ksize=1, scale=-(sigma**2) * share, borderType=cv2.BORDER_REPLICATE)
            for order, share in (((2, 0), 1.0), ((1, 1), 0.25), ((0, 2), 1.0))
        )
        inside = absorption.inside[cell_px // 2 :: cell_px, cell_px // 2 :: cell_px][:rows, :columns]
        return cls(cell_px, sigma, smooth, uu, uv, vv, np.ascontiguousarray(inside))

    @cached_property
    def greater(self) -> Array32:
        """The larger eigenvalue of the second derivatives: large at dark wires, across them."""
        return np.asarray(self._mean + self._spread)

    @cached_property
    def lesser(self) -> Array32:
        """The smaller eigenvalue: large at dark spots, small along wires and edges."""
        return np.asarray(self._mean - self._spread)

    @cached_property
    def _mean(self) -> Array32:
        return np.asarray(cv2.addWeighted(self.uu, 0.5, self.vv, 0.5, 0.0))

    @cached_property
    def _spread(self) -> Array32:
        return np.asarray(cv2.magnitude(cv2.addWeighted(self.uu, 0.5, self.vv, -0.5, 0.0), self.uv))

    def noise_of(self, measure: Array32) -> float:
        """Robust standard deviation of a measure (rows, columns) over the field; most of it is anatomy, not noise."""
        some = (slice(None, None, _EVERY), slice(None, None, _EVERY))
        chosen = measure[some][self.inside[some]]
        return _SD_OF_MEDIAN * float(np.median(np.abs(chosen))) if len(chosen) else 0.0

    def raw_from_cells(self, cells: Array) -> Array:
        """Raw pixels (n, 2) of places (n, 2) counted in cells, both from the centre of the first."""
        return np.asarray((cells + 0.5) * self.cell_px - 0.5)

    def cells_at(self, raw: Array) -> tuple[NDArray[np.intp], NDArray[np.bool_]]:
        """Number (n,), row by row, of the cells that hold raw pixels (n, 2), and which of those lie in the image."""
        column, row = np.floor((raw + 0.5) / self.cell_px).astype(np.intp).T
        rows, columns = self.smooth.shape
        seen: NDArray[np.bool_] = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        return np.where(seen, row * columns + column, 0), seen

    def slopes(self, row: NDArray[np.intp], column: NDArray[np.intp]) -> tuple[Array32, Array32]:
        """First derivatives (n,) of the smoothed absorption along u and v at cells, per cell."""
        last_row, last_column = self.smooth.shape[0] - 1, self.smooth.shape[1] - 1
        right, left = np.minimum(column + 1, last_column), np.maximum(column - 1, 0)
        below, above = np.minimum(row + 1, last_row), np.maximum(row - 1, 0)
        along_u = (self.smooth[row, right] - self.smooth[row, left]) / np.float32(2.0)
        along_v = (self.smooth[below, column] - self.smooth[above, column]) / np.float32(2.0)
        return along_u, along_v

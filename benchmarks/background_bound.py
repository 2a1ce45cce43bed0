"""The Cramer-Rao bound where the background is not known but noise of its own, which neighbouring pixels share.

In absorption wires add to what lies behind them, so that the background is a noise beside that of the quanta. Its power
is taken from the scene itself rendered without wires and balls: tile by tile, since bone is rougher than tissue, the
mean over all directions of its spectrum there and in the tiles around. In each tile the information is the sum over
frequencies of the signals' spectra over the noise's (Whittle).
"""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter

from benchmarks.pixel_bound import Bound, Changes, bound_of, field_weights, noise_variance
from simulator.carm.scene import Scene
from vision.devices import Guide

Array = NDArray[np.float64]

_TILE = 32  # px: several wires wide, and small against a vertebra
_STEP = _TILE // 2  # so that the squared windows of all tiles add up to 1
_LEAST_LIGHT = 1e-4  # of the white: beyond the field there is nothing to see


def background_bound(scene: Scene, guide: Guide, changes: Changes) -> Bound:
    """Of one scene, for its target at the default depth."""
    light = np.maximum(changes.clean, _LEAST_LIGHT)
    fields, quanta = changes.fields / light, noise_variance(light, scene) / light**2
    power = _background_power(np.log(np.maximum(changes.background, _LEAST_LIGHT)))
    middle = np.array([(_TILE - 1) / 2.0, (_TILE - 1) / 2.0])
    parts = []
    for row, column in np.ndindex(power.shape[:2]):
        top, left = _STEP * row, _STEP * column
        part = np.s_[top : top + _TILE, left : left + _TILE]
        if np.any(fields[:, *part]):
            weights = field_weights(scene, np.add(middle, (left, top))[None])[0]
            density = _quanta_power(fields[:, *part], quanta[part]) + power[row, column][_RADIUS]
            parts.append(weights.T @ _information(fields[:, *part], density) @ weights)
    return bound_of(scene, guide, np.sum(parts, axis=0))


def _information(fields: Array, density: Array) -> Array:
    """Of a tile's fields (k, 32, 32) in noise of a power density (32, 32): (k, k)."""
    signals = np.fft.fft2(_WINDOW * fields).reshape(len(fields), -1)
    return np.asarray(((signals / density.ravel()) @ signals.conj().T).real / _TILE**2)


def _quanta_power(fields: Array, quanta: Array) -> float:
    """The quanta's variance where a tile's fields (k, 32, 32) are strong: behind a wire there are fewer."""
    strength = (_WINDOW * fields) ** 2
    return float((strength * quanta).sum() / strength.sum())


def _radius() -> NDArray[np.intp]:
    """Of each frequency of a tile (32, 32), in steps of its spectrum."""
    steps = np.fft.fftfreq(_TILE, 1.0 / _TILE)
    return np.rint(np.hypot(*np.meshgrid(steps, steps))).astype(np.intp)


def _window() -> Array:
    """Over a tile (32, 32), 0 at its rim."""
    side = np.sin(np.pi * (np.arange(_TILE) + 0.5) / _TILE)
    return np.outer(side, side)


_RADIUS, _WINDOW = _radius(), _window()


def _background_power(absorption: Array) -> Array:
    """Mean power by radius (tiles down, tiles across, radii), of a tile and the eight around it."""
    plane = np.column_stack([axis.ravel() for axis in (np.ones_like(_WINDOW), *np.indices(_WINDOW.shape))])
    flat = plane @ np.linalg.pinv(plane)
    tiles = np.lib.stride_tricks.sliding_window_view(absorption, _WINDOW.shape)[::_STEP, ::_STEP]
    counts = np.bincount(_RADIUS.ravel())
    power = np.zeros((*tiles.shape[:2], len(counts)))
    for row in range(tiles.shape[0]):
        level = tiles[row].reshape(tiles.shape[1], -1)
        level = (level - level @ flat.T).reshape(tiles.shape[1:])
        spectra = np.abs(np.fft.fft2(_WINDOW * level)) ** 2 / (_WINDOW**2).sum()
        for column, spectrum in enumerate(spectra):
            power[row, column] = np.bincount(_RADIUS.ravel(), spectrum.ravel()) / counts
    return np.asarray(uniform_filter(power, (3, 3, 1), mode="nearest"))

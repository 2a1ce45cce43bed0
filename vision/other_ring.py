"""Where the other ring of a guide must be of which one ring is seen.

A ring's ellipse tells how far away it is and, but for two signs and the less surely the more it is seen along its axis,
where that axis points. The other ring lies on it, its ellipse of nearly the same shape.
"""

import math

import numpy as np
from numpy.typing import NDArray

from vision.conics import Ellipse, conic_from_ellipse
from vision.devices import Guide
from vision.projection import Intrinsics

Array = NDArray[np.float64]

_STEP_RAD = math.radians(1.5)  # of the axis: moves the other ring by less than a refit follows
_GREATEST_TILT_RAD = math.radians(45.0)
_SHAPE_WITHIN = 0.05  # of the semi-major axis: errors of a candidate's axes, and what perspective adds to the shape


def other_rings(ring: Ellipse, guide: Guide, nominal: Intrinsics) -> Array:
    """Ellipses that the other ring may have.

    Parameters
    ----------
    ring : Ellipse
        Corrected pixels; as the small ring and as the big one.
    guide, nominal
        Radii and separation, mm; intrinsics, corrected pixels.

    Returns
    -------
    Array
        (h, 5), forms as in `ellipse_forms`, corrected pixels.
    """
    small, big = guide.small_ring_radius_mm, guide.big_ring_radius_mm
    tilts, matrix = _tilts(ring), nominal.matrix()
    ray = np.asarray(np.linalg.solve(matrix, (*ring.centre_px, 1.0)), dtype=np.float64)
    conic = conic_from_ellipse(ring)
    shape = np.array([conic[0, 0], 2.0 * conic[0, 1], conic[1, 1]])
    forms = []
    for radius_mm, other_mm, along_mm in ((small, big, -guide.separation_mm), (big, small, guide.separation_mm)):
        depth_mm = nominal.alpha_x_px * radius_mm / ring.semi_axes_px[0]
        centres = depth_mm * ray + along_mm * _axes(ray, tilts)
        scale = other_mm / radius_mm * depth_mm / centres[:, 2:]
        forms.append(np.hstack(((centres @ matrix.T)[:, :2] / centres[:, 2:], shape / scale**2)))
    return np.concatenate(forms)


def _tilts(ring: Ellipse) -> Array:
    """Tilts (n, 2) against the ray through a ring, rad along u and v, at which it looks about like its ellipse."""
    steps = np.arange(-_GREATEST_TILT_RAD, _GREATEST_TILT_RAD + _STEP_RAD / 2.0, _STEP_RAD)
    tilts = np.column_stack([axis.ravel() for axis in np.meshgrid(steps, steps)])
    size = np.hypot(*tilts.T)
    across = tilts / np.maximum(size, np.finfo(float).tiny)[:, None]
    # a circle is shortened along its tilt by the cosine
    shapes = np.eye(2) - (1.0 - np.cos(size))[:, None, None] * across[:, :, None] * across[:, None, :]
    minor = np.array([-math.sin(ring.angle_rad), math.cos(ring.angle_rad)])
    seen = np.eye(2) - (1.0 - ring.semi_axes_px[1] / ring.semi_axes_px[0]) * np.outer(minor, minor)
    alike = np.linalg.norm(shapes - seen, axis=(1, 2)) < _SHAPE_WITHIN
    return np.asarray(tilts[alike & (size < _GREATEST_TILT_RAD)])


def _axes(ray: Array, tilts: Array) -> Array:
    """Unit axes (n, 3), source frame, tilted against a ray (3,)."""
    along = ray / np.linalg.norm(ray)
    side = np.cross((0.0, 1.0, 0.0), along)
    side /= np.linalg.norm(side)
    size = np.hypot(*tilts.T)[:, None]
    return np.asarray(np.cos(size) * along + np.sinc(size / np.pi) * (tilts @ np.stack((side, np.cross(along, side)))))

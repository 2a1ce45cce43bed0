"""First views laid onto the two ellipses they came from, so that the line is looked for where it is.

With the principal point and the distance as the file has them a steep view misses the rings by several pixels. All
pairs of an image are laid together: each takes but a few numbers.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.conics import Ellipse
from vision.devices import Guide
from vision.first_pose import RingView
from vision.priors import Priors
from vision.projection import Intrinsics, View

Array = NDArray[np.float64]

_PLACES = 24  # on each ellipse: it is smooth
_ELLIPSE_SD_PX = 0.5  # of one place on a candidate ellipse; the places of an ellipse are off together
_WORST_SHARE = 0.025  # root mean square, of the small ring's size; rings of another size or separation leave more
_ROUNDS = 6
# Steps of about equal effect on the image: alpha (relative), centre (px), tilt (rad), translation (mm)
_SCALES = np.array([3e-3, 5.0, 5.0, 2e-3, 2e-3, 0.5, 0.5, 3.0])
_DIFFERENCE = 1e-3  # of the scales, for derivatives
_WAYS = np.vstack((np.zeros(len(_SCALES)), np.eye(len(_SCALES)) * _DIFFERENCE))


@dataclass(frozen=True, slots=True, eq=False)
class _Views:
    """Views (p,) as arrays: alpha, u0, v0 (p, 3), rotation (p, 3, 3), translation (p, 3)."""

    intrinsics: Array
    rotation: Array
    translation: Array

    def repeated(self, times: int) -> "_Views":
        """Each of them so many times."""
        return _Views(*(np.repeat(part, times, axis=0) for part in (self.intrinsics, self.rotation, self.translation)))

    def moved(self, step: Array) -> "_Views":
        """Stepped by (p, 8) in units of the scales; the tilt is about the guide's own x and y."""
        step = step * _SCALES
        intrinsics = self.intrinsics + step[:, :3] * np.column_stack((self.intrinsics[:, 0], np.ones((len(step), 2))))
        turns = Rotation.from_rotvec(np.column_stack((step[:, 3:5], np.zeros(len(step))))).as_matrix()
        return _Views(intrinsics, self.rotation @ turns, self.translation + step[:, 5:])


def aligned(pairs: Sequence[RingView], guide: Guide, priors: Priors) -> list[RingView]:
    """The pairs, their views fitted to both ellipses under the priors; the turn about the guide's axis stays open.

    Parameters
    ----------
    pairs : Sequence[RingView]
        Views by the rings' centres and sizes.
    guide, priors
        By the device files.

    Returns
    -------
    list[RingView]
        In the same order, those left out that the guide of the file cannot look like.
    """
    if not pairs:
        return []
    views = _arrays([pair.view for pair in pairs])
    places = np.array([[_around(pair.rings.small), _around(pair.rings.big)] for pair in pairs])
    every = np.repeat(places, len(_WAYS), axis=0)
    # a pair that cannot be the guide's may run away, and is left out by its misfit; the others must not notice
    with np.errstate(all="ignore"):
        for _ in range(_ROUNDS):
            around = _residual(views.repeated(len(_WAYS)).moved(np.tile(_WAYS, (len(pairs), 1))), every, guide, priors)
            views = views.moved(_step(around.reshape(len(pairs), len(_WAYS), -1)))
        off_px = np.sqrt((_misfit_px(views, places, guide) ** 2).mean(axis=(1, 2)))
    sizes_px = np.array([pair.rings.small.semi_axes_px[0] for pair in pairs])
    fits = off_px < _WORST_SHARE * sizes_px
    return [replace(pair, view=_view(views, index)) for index, pair in enumerate(pairs) if fits[index]]


def _step(around: Array) -> Array:
    """Steps (p, 8) of Gauss and Newton from residuals (p, 9, r), the first at the views, the others a way off."""
    here = around[:, 0]
    jacobian = ((around[:, 1:] - around[:, :1]) / _DIFFERENCE).swapaxes(1, 2)
    gradient = (jacobian.swapaxes(1, 2) @ here[:, :, None])[:, :, 0]
    normal = jacobian.swapaxes(1, 2) @ jacobian
    sound = np.isfinite(normal).all(axis=(1, 2)) & np.isfinite(gradient).all(axis=1)
    normal[~sound] = np.eye(len(_SCALES))
    sound &= np.linalg.slogdet(normal)[0] > 0.0  # views that run away may lose a direction altogether
    normal[~sound], gradient[~sound] = np.eye(len(_SCALES)), np.nan
    return np.asarray(-np.linalg.solve(normal, gradient[:, :, None])[:, :, 0])


def _residual(views: _Views, places: Array, guide: Guide, priors: Priors) -> Array:
    """Everything in its standard deviations (p, 2 * places + 3)."""
    nominal = priors.nominal
    off = views.intrinsics - (nominal.alpha_x_px, nominal.u0_px, nominal.v0_px)
    pulls = off / (priors.alpha_sd_px, priors.centre_sd_px, priors.centre_sd_px)
    rings = _misfit_px(views, places, guide).reshape(len(off), -1) / _ELLIPSE_SD_PX
    return np.hstack((rings, pulls))


def _misfit_px(views: _Views, places: Array, guide: Guide) -> Array:
    """How far places (p, 2, n, 3) on both ellipses, seen back in the rings' planes, lie outside the rings: (p, 2, n).

    In pixels by the ring's mean scale.
    """
    matrix = np.zeros((len(places), 3, 3))
    matrix[:, 0, 0] = matrix[:, 1, 1] = views.intrinsics[:, 0]
    matrix[:, :2, 2], matrix[:, 2, 2] = views.intrinsics[:, 1:], 1.0
    radii, misfit = (guide.small_ring_radius_mm, guide.big_ring_radius_mm), []
    for ring, (radius_mm, z_mm) in enumerate(zip(radii, (0.0, -guide.separation_mm), strict=True)):
        source_from_plane = views.rotation.copy()
        source_from_plane[:, :, 2] = views.rotation[:, :, 2] * z_mm + views.translation
        on_plane = places[:, ring] @ _adjugate_transposed(matrix @ source_from_plane)
        distance_mm = np.hypot(on_plane[:, :, 0], on_plane[:, :, 1]) / on_plane[:, :, 2]
        per_mm = views.intrinsics[:, 0] / source_from_plane[:, 2, 2]
        misfit.append((distance_mm - radius_mm) * per_mm[:, None])
    return np.stack(misfit, axis=1)


def _adjugate_transposed(matrices: Array) -> Array:
    """Of (p, 3, 3): the inverses' transposes but for a factor, and defined where a matrix has no inverse."""
    (a, b, c), (d, e, f), (g, h, i) = matrices.transpose(1, 2, 0)
    rows = ((e * i - f * h, f * g - d * i, d * h - e * g), (h * c - i * b, i * a - g * c, g * b - h * a))
    return np.array((*rows, (b * f - c * e, c * d - a * f, a * e - b * d))).transpose(2, 0, 1)


def _around(ellipse: Ellipse) -> Array:
    """Homogeneous places (n, 3) on an ellipse, corrected pixels."""
    angle = np.linspace(0.0, 2.0 * np.pi, _PLACES, endpoint=False)
    along, across = ellipse.semi_axes_px[0] * np.cos(angle), ellipse.semi_axes_px[1] * np.sin(angle)
    cosine, sine = np.cos(ellipse.angle_rad), np.sin(ellipse.angle_rad)
    u, v = along * cosine - across * sine, along * sine + across * cosine
    return np.column_stack((u + ellipse.centre_px[0], v + ellipse.centre_px[1], np.ones(_PLACES)))


def _arrays(views: Sequence[View]) -> _Views:
    intrinsics = np.array([(v.intrinsics.alpha_x_px, v.intrinsics.u0_px, v.intrinsics.v0_px) for v in views])
    poses = np.array([view.source_from_guide for view in views])
    return _Views(intrinsics, poses[:, :3, :3], poses[:, :3, 3])


def _view(views: _Views, index: int) -> View:
    alpha_px, u0_px, v0_px = (float(value) for value in views.intrinsics[index])
    pose = np.eye(4)
    pose[:3, :3], pose[:3, 3] = views.rotation[index], views.translation[index]
    return View(Intrinsics(alpha_px, alpha_px, u0_px, v0_px), pose)

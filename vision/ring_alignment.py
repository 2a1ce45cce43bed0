"""A first view laid onto the two ellipses it came from, so that the line is looked for where it is.

With the principal point and the distance as the file has them a steep view misses the rings by several pixels.
"""

import numpy as np
from numpy.typing import NDArray

from vision.conics import RingPair, conic_from_ellipse
from vision.contour import Observations, Priors, residual_px, solve_view
from vision.devices import Guide
from vision.projection import View
from vision.wire_model import Wire, WireSamples, sample_wires

Array = NDArray[np.float64]

_EVERY = 8  # sample of the rings: an ellipse is smooth
_ELLIPSE_SD_PX = 1.0  # of the candidate ellipses
_TURN_SD_PX = 3.0
_WORST_PX = 2.0  # root mean square; rings of another size or separation leave more
_ROUNDS = 3


def aligned(view: View, rings: RingPair, guide: Guide, priors: Priors) -> View | None:
    """The view fitted to both ellipses under the priors; its turn about the guide's axis stays open.

    Parameters
    ----------
    view : View
        By the rings' centres and sizes.
    rings : RingPair
        Corrected pixels.
    guide, priors
        By the device files.

    Returns
    -------
    View or None
        None where the guide of the file cannot look like these ellipses.
    """
    for _ in range(_ROUNDS):
        observations = _on_ellipses(view, rings, guide)
        weight = np.ones(len(observations.along))
        view, _ = solve_view(view, guide, observations, priors, weight, _ELLIPSE_SD_PX)
    left = residual_px(view, guide, _on_ellipses(view, rings, guide))
    return view if float(np.sqrt((left**2).mean())) < _WORST_PX else None


def _on_ellipses(view: View, rings: RingPair, guide: Guide) -> Observations:
    """Where the ellipses cross the normals of the projected rings."""
    samples = sample_wires(view, guide)
    chosen, measured = [], []
    for wire, ellipse in ((Wire.SMALL_RING, rings.small), (Wire.BIG_RING, rings.big)):
        on = samples.chosen((samples.wire == wire) & (np.arange(len(samples.along)) % _EVERY == 0))
        distance = _to_conic(conic_from_ellipse(ellipse), on.points, on.normals)
        chosen.append(on)
        measured.append(on.points + distance[:, None] * on.normals)
    wires, along, normals = (
        np.concatenate([getattr(on, name) for on in chosen]) for name in ("wire", "along", "normals")
    )
    return Observations(wires, along, np.concatenate(measured), normals, *_held_turn(samples))


def _held_turn(samples: WireSamples) -> tuple[Array, Array, Array, Array]:
    """The line's end where it is, so that the rings, which leave the turn open, do not let it run away."""
    x_mm = float(samples.along[-1])
    sd_px = np.array([_TURN_SD_PX])
    return np.array([[x_mm, 0.0, 0.0]]), samples.points[-1:], samples.normals[-1:], sd_px


def _to_conic(conic: Array, points: Array, normals: Array) -> Array:
    """Signed distance (n,) along the normals to the nearer crossing with a conic; to the chord's middle without one."""
    start = np.column_stack((points, np.ones(len(points))))
    way = np.column_stack((normals, np.zeros(len(points))))
    a, b, c = (
        np.einsum("ni,ij,nj->n", left, conic, right) for left, right in ((way, way), (way, start), (start, start))
    )
    root = np.sqrt(np.clip(b * b - a * c, 0.0, None))
    near, far = (-b + root) / a, (-b - root) / a
    return np.asarray(np.where(np.abs(near) < np.abs(far), near, far), dtype=np.float64)

"""One view by least squares: what was measured, the projected model beside it, and Gauss-Newton between them."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from vision.devices import Guide
from vision.priors import Priors
from vision.projection import View, project, projection_jacobian
from vision.wire_model import dimension_directions, points_in_guide, with_dimensions

Array = NDArray[np.float64]
Whitening = Callable[[Array], Array]  # (n, ...) of the places in their standard deviations, independent of one another

_GREATEST_STEPS, _HALVINGS = 12, 6
_RUNAWAY = 500.0  # of the scales below: a radian, or a quarter of a metre across; no first view is that far off
_SETTLED = 1e-4  # squared standard deviations of the solution: a step of a hundredth of them moves nothing


@dataclass(frozen=True, slots=True, eq=False)
class Observations:
    """What was measured in the image, each along one direction.

    Attributes
    ----------
    wire, along
        (n,) each: places on the wires, as in `WireSamples`.
    measured : Array
        (n, 2), corrected pixels.
    normals : Array
        (n, 2): the direction in which each place was measured.
    sd_px : Array
        (n,): of each place by the noise of its own pixels.
    extra_in_guide, extra_measured, extra_normals, extra_sd_px
        The same for single points (line ends, bead): (m, 3) mm, (m, 2), (m, 2), (m,).
    """

    wire: NDArray[np.intp]
    along: Array
    measured: Array
    normals: Array
    sd_px: Array
    extra_in_guide: Array
    extra_measured: Array
    extra_normals: Array
    extra_sd_px: Array


def solve_view(
    view: View, guide: Guide, observations: Observations, priors: Priors, whitened: Whitening
) -> tuple[View, Guide]:
    """One least-squares solution for a given noise of the places on the wires.

    Gauss-Newton, a step halved while it makes things worse: near the solution the projection is almost linear.

    Raises
    ------
    numpy.linalg.LinAlgError
        If there is no finite step: the view is far from anything that the places can be of.
    """
    left = _in_deviations(view, guide, observations, priors, whitened)
    for _ in range(_GREATEST_STEPS):
        scaled = design(view, guide, observations, priors, whitened) * _SCALES
        downhill = -scaled.T @ left
        move = np.linalg.solve(scaled.T @ scaled, downhill)
        if not np.abs(move).max() < _RUNAWAY:  # nan too
            raise np.linalg.LinAlgError("the fit of a view runs away")
        for _ in range(_HALVINGS):
            ahead = _moved(view, guide, move * _SCALES)
            left_ahead = _in_deviations(*ahead, observations, priors, whitened)
            if left_ahead @ left_ahead <= left @ left:
                (view, guide), left = ahead, left_ahead
                break
            move = move / 2.0
        if move @ downhill < _SETTLED:
            break
    return view, guide


def residual_px(view: View, guide: Guide, observations: Observations) -> Array:
    """Distance (n,) of each measured place from the model along its normal, corrected px."""
    model = project(view, points_in_guide(guide, observations.wire, observations.along))
    return np.asarray(((observations.measured - model) * observations.normals).sum(axis=1))


def design(view: View, guide: Guide, observations: Observations, priors: Priors, whitened: Whitening) -> Array:
    """Derivative (n + m + 7, 13) of everything in its standard deviations: places on wires, single points, priors."""
    points = points_in_guide(guide, observations.wire, observations.along)
    by_view = projection_jacobian(view, points, observations.normals)
    by_place_in_guide = by_view[:, 7:] @ view.source_from_guide[:3, :3]
    directions = dimension_directions(observations.wire, observations.along)
    by_dimension = (by_place_in_guide[:, :, None] * directions).sum(axis=1)
    extra = projection_jacobian(view, observations.extra_in_guide, observations.extra_normals)
    return np.vstack(
        (
            whitened(-np.hstack((by_view, by_dimension))),
            np.hstack((extra / -observations.extra_sd_px[:, None], np.zeros((len(extra), 3)))),
            priors.rows(),
        )
    )


def _in_deviations(view: View, guide: Guide, observations: Observations, priors: Priors, whitened: Whitening) -> Array:
    """Everything in its standard deviations, the rows as of `design`."""
    model = project(view, observations.extra_in_guide)
    extra = ((observations.extra_measured - model) * observations.extra_normals).sum(axis=1)
    return np.concatenate(
        (
            whitened(residual_px(view, guide, observations)),
            extra / observations.extra_sd_px,
            list(priors.pulls(view, guide).values()),
        )
    )


# Steps of about equal effect on the image: px, rad, mm; then the guide's radii and separation, mm.
_SCALES = np.array([10.0, 10.0, 5.0, 5.0, 2e-3, 2e-3, 2e-3, 0.5, 0.5, 3.0, 0.02, 0.02, 0.03])


def _moved(view: View, guide: Guide, step: Array) -> tuple[View, Guide]:
    """A step of the 13 parameters, the pose's applied on the left in the source frame."""
    intrinsics, pose = view.intrinsics, view.source_from_guide.copy()
    pose[:3, :3] = Rotation.from_rotvec(step[4:7]).as_matrix() @ pose[:3, :3]
    pose[:3, 3] += step[7:10]
    moved = replace(
        intrinsics,
        alpha_x_px=intrinsics.alpha_x_px + float(step[0]),
        alpha_y_px=intrinsics.alpha_y_px + float(step[1]),
        u0_px=intrinsics.u0_px + float(step[2]),
        v0_px=intrinsics.v0_px + float(step[3]),
    )
    dimensions = with_dimensions(
        guide,
        guide.small_ring_radius_mm + float(step[10]),
        guide.big_ring_radius_mm + float(step[11]),
        guide.separation_mm + float(step[12]),
    )
    return View(moved, pose), dimensions

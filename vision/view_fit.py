"""One view by least squares: what was measured, the projected model beside it, and Gauss-Newton between them."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.priors import Priors
from vision.projection import Intrinsics, View, project, projection_jacobian
from vision.wire_model import Wire, dimension_directions, with_dimensions
from vision.wire_noise import PlaceCovariance

Array = NDArray[np.float64]

_GREATEST_STEPS, _HALVINGS = 12, 6
_RUNAWAY = 500.0  # of the scales below: a radian, or a quarter of a metre across; no first view is that far off
_SETTLED = 1e-8  # squared standard deviations of the solution: a step of a ten-thousandth of them moves nothing
_STRAIGHT = 1.0  # the same: over such a step the derivative stays what it is, to some thousandths of itself


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


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Observations with what of their model no view and no dimension changes.

    Attributes
    ----------
    fixed, moves : Array
        (n, 3) and (n, 3, 3): a place in the guide frame is `fixed + moves @ dimensions`, mm.
    """

    observations: Observations
    fixed: Array
    moves: Array

    @classmethod
    def of(cls, observations: Observations) -> "Places":
        """Of observations."""
        wire, along = observations.wire, observations.along
        on_line = np.where(wire == Wire.LINE, along, 0.0)
        fixed = np.column_stack((on_line, np.zeros((len(along), 2))))
        return cls(observations, fixed, dimension_directions(wire, along))

    def residual_px(self, view: View, guide: Guide) -> Array:
        """Distance (n,) of each measured place from the model along its normal, corrected px."""
        seen = self.observations
        return np.asarray(((seen.measured - project(view, self._in_guide(guide))) * seen.normals).sum(axis=1))

    def design(self, view: View, guide: Guide) -> Array:
        """Derivative (n, 13) of the residuals by the parameters, px."""
        by_view = projection_jacobian(view, self._in_guide(guide), self.observations.normals)
        by_place_in_guide = by_view[:, 7:] @ view.source_from_guide[:3, :3]
        by_dimension = np.einsum("ni,nid->nd", by_place_in_guide, self.moves)
        return -np.hstack((by_view, by_dimension))

    def others(self, view: View, guide: Guide, priors: Priors) -> Array:
        """Single points and priors (m + 7,) in their standard deviations."""
        seen = self.observations
        single = ((seen.extra_measured - project(view, seen.extra_in_guide)) * seen.extra_normals).sum(axis=1)
        return np.concatenate((single / seen.extra_sd_px, list(priors.pulls(view, guide).values())))

    def others_design(self, view: View, priors: Priors) -> Array:
        """Derivative (m + 7, 13) of `others` by the parameters."""
        seen = self.observations
        single = projection_jacobian(view, seen.extra_in_guide, seen.extra_normals) / -seen.extra_sd_px[:, None]
        return np.vstack((np.hstack((single, np.zeros((len(single), 3)))), priors.rows()))

    def information(self, view: View, guide: Guide, priors: Priors, covariance: PlaceCovariance) -> Array:
        """Inverse covariance (13, 13) of the parameters."""
        by_places, by_others = self.design(view, guide), self.others_design(view, priors)
        return np.asarray(by_places.T @ covariance.solved(by_places) + by_others.T @ by_others)

    def _in_guide(self, guide: Guide) -> Array:
        dimensions = np.array([guide.small_ring_radius_mm, guide.big_ring_radius_mm, guide.separation_mm])
        return np.asarray(self.fixed + (self.moves.reshape(-1, 3) @ dimensions).reshape(-1, 3))


def solve_view(
    view: View, guide: Guide, places: Places, priors: Priors, covariance: PlaceCovariance
) -> tuple[View, Guide]:
    """One least-squares solution for a given covariance of the places on the wires.

    Gauss-Newton, a step halved while it makes things worse: near the solution the projection is almost linear, and the
    derivative is taken anew only while the steps are long.

    Raises
    ------
    numpy.linalg.LinAlgError
        If there is no finite step: the view is far from anything that the places can be of.
    """
    slopes = _Slopes.of(view, guide, places, priors, covariance)
    for _ in range(_GREATEST_STEPS):
        left = _Left.of(view, guide, places, priors)
        downhill = slopes.downhill(left)
        move = np.linalg.solve(slopes.information, downhill)
        if not np.abs(move).max() < _RUNAWAY:  # nan too
            raise np.linalg.LinAlgError("the fit of a view runs away")
        gain = float(move @ downhill)
        if gain < _STRAIGHT:
            view, guide = _moved(view, guide, move * _SCALES)
            if gain < _SETTLED:
                break
            continue
        cost = left.cost(covariance)
        for _ in range(_HALVINGS):
            ahead = _moved(view, guide, move * _SCALES)
            if _Left.of(*ahead, places, priors).cost(covariance) <= cost:
                view, guide = ahead
                break
            move = move / 2.0
        else:
            break
        slopes = _Slopes.of(view, guide, places, priors, covariance)
    return view, guide


@dataclass(frozen=True, slots=True, eq=False)
class _Left:
    """What a view leaves: the places' residuals (n,), px, and the others (m + 7,) in their standard deviations."""

    places: Array
    others: Array

    @classmethod
    def of(cls, view: View, guide: Guide, places: Places, priors: Priors) -> "_Left":
        return cls(places.residual_px(view, guide), places.others(view, guide, priors))

    def cost(self, covariance: PlaceCovariance) -> float:
        """Sum of squares of independent standard deviations."""
        return float(self.places @ covariance.solved(self.places[:, None])[:, 0] + self.others @ self.others)


@dataclass(frozen=True, slots=True, eq=False)
class _Slopes:
    """Derivatives by the parameters in units of `_SCALES`.

    Attributes
    ----------
    weighted : Array
        (n, 13): the places', behind their inverse covariance.
    others : Array
        (m + 7, 13): those of the others.
    information : Array
        (13, 13): of them all.
    """

    weighted: Array
    others: Array
    information: Array

    @classmethod
    def of(cls, view: View, guide: Guide, places: Places, priors: Priors, covariance: PlaceCovariance) -> "_Slopes":
        by_places = places.design(view, guide) * _SCALES
        by_others = places.others_design(view, priors) * _SCALES
        weighted = covariance.solved(by_places)
        return cls(weighted, by_others, by_places.T @ weighted + by_others.T @ by_others)

    def downhill(self, left: _Left) -> Array:
        """Minus half the derivative (13,) of the cost."""
        return np.asarray(-(self.weighted.T @ left.places + self.others.T @ left.others))


# Steps of about equal effect on the image: px, rad, mm; then the guide's radii and separation, mm.
_SCALES = np.array([10.0, 10.0, 5.0, 5.0, 2e-3, 2e-3, 2e-3, 0.5, 0.5, 3.0, 0.02, 0.02, 0.03])


def _moved(view: View, guide: Guide, step: Array) -> tuple[View, Guide]:
    """A step of the 13 parameters, the pose's applied on the left in the source frame."""
    intrinsics, pose = view.intrinsics, view.source_from_guide.copy()
    pose[:3, :3] = cv2.Rodrigues(step[4:7])[0] @ pose[:3, :3]
    pose[:3, 3] += step[7:10]
    moved = Intrinsics(
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

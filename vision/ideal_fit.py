"""The registration as a linear estimator: what each error in the image and in the files does to the view.

It is the best linear one: places on the wires and the distortion map's error by their covariance, the files as priors.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.distortion import PlateFit
from vision.priors import VIEW_PARAMETERS, Priors
from vision.projection import View, project, projection_jacobian
from vision.uncertainty import moved_view
from vision.wire_model import dimension_directions, points_in_guide, sample_wires, with_dimensions

Array = NDArray[np.float64]

_ROUNDS = 5  # with the gain at the start: a prior of 3 % leaves 0.03 of a step's error each


@dataclass(frozen=True, slots=True, eq=False)
class IdealFit:
    """Gains of the estimator about a view.

    Attributes
    ----------
    wire, along
        (n,) each: places on the wires, as in `WireSamples`.
    normals : Array
        (n, 2), unit, corrected pixels.
    bend : Array
        (n, 2, m): what the map's coefficients of u and of v do to each place along its normal.
    gain : Array
        (13, n): parameters by residuals, px.
    prior_gain : Array
        (13, 7): parameters by the priors' errors, in their standard deviations.
    prior_rows : Array
        (7, 13): the priors' pulls by the parameters.
    """

    view: View
    guide: Guide
    wire: NDArray[np.intp]
    along: Array
    normals: Array
    bend: Array
    gain: Array
    prior_gain: Array
    prior_rows: Array

    @classmethod
    def of(cls, view: View, guide: Guide, priors: Priors, plate: PlateFit, noise_px: float) -> "IdealFit":
        """Of a view and a guide; `noise_px` is what one pixel of a wire's length is worth."""
        samples = sample_wires(view, guide)
        basis = plate.map.basis(plate.map.raw_from_corrected(samples.points))
        bend = samples.normals[:, :, None] * basis[:, None, :]
        shared = np.einsum("nac,cd,mad->nm", bend, plate.coefficient_covariance, bend, optimize=True)
        design = _design(view, guide, samples.wire, samples.along, samples.normals)
        weighted = np.linalg.solve(shared + noise_px**2 * np.eye(len(shared)), design)
        rows = priors.rows()
        inverse = np.linalg.inv(design.T @ weighted + rows.T @ rows)
        gains = np.asarray(inverse @ weighted.T), np.asarray(inverse @ rows.T)
        return cls(view, guide, samples.wire, samples.along, samples.normals, bend, *gains, rows)

    def measured(self, view: View, guide: Guide) -> Array:
        """Where the places lie along their normals (n,) in another view of another guide, px."""
        points = project(view, points_in_guide(guide, self.wire, self.along))
        return np.asarray((points * self.normals).sum(axis=1))

    def moved(self, step: Array) -> tuple[View, Guide]:
        """View and guide a step (13,) away."""
        guide, (small_mm, big_mm, separation_mm) = self.guide, step[VIEW_PARAMETERS:].tolist()
        dimensions = with_dimensions(
            guide,
            guide.small_ring_radius_mm + small_mm,
            guide.big_ring_radius_mm + big_mm,
            guide.separation_mm + separation_mm,
        )
        return moved_view(self.view, step[:VIEW_PARAMETERS]), dimensions

    def solved(self, measured: Array) -> View:
        """The view that an image (n,) of places along the normals is registered as, priors at the middle of this fit.

        Iterated with the projection itself, so that nothing but the gain is linear.
        """
        step = np.zeros(len(self.gain))
        for _ in range(_ROUNDS):
            left = measured - self.measured(*self.moved(step))
            step = step + self.gain @ left - self.prior_gain @ (self.prior_rows @ step)
        return self.moved(step)[0]


def _design(view: View, guide: Guide, wire: NDArray[np.intp], along: Array, normals: Array) -> Array:
    """Derivative (n, 13) of the places along their normals by view and dimensions."""
    by_view = projection_jacobian(view, points_in_guide(guide, wire, along), normals)
    by_place_in_guide = by_view[:, 7:] @ view.source_from_guide[:3, :3]
    by_dimension = (by_place_in_guide[:, :, None] * dimension_directions(wire, along)).sum(axis=1)
    return np.hstack((by_view, by_dimension))

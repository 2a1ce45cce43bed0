"""What several images of one fixed C-arm and one guide say together: each by itself, without the priors of the files.

Every registration leans on the same device files. Taken together they would count those as often as there are images,
so the files' share is taken out of each and returned once.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision.common_grid import similarity_between
from vision.priors import Priors
from vision.projection import View, nominal_intrinsics
from vision.registered import FittedDimensions, Registration, joint_covariance
from vision.wire_model import with_dimensions

Array = NDArray[np.float64]

_SHARED = [0, 1, 2, 3, 10, 11, 12]  # alpha_x, alpha_y, u0, v0, two radii, separation
_POSE = [4, 5, 6, 7, 8, 9]
_KNOWN = 1e-9  # of the largest information: below it nothing was measured in this direction


@dataclass(frozen=True, slots=True, eq=False)
class Sighting:
    """What one image says by itself.

    Attributes
    ----------
    source_from_guide : Array
        (4, 4), mm, in the first image's grid.
    shared : Array
        (7,): alpha_x, alpha_y, u0, v0 (px), radius of the small ring, of the big one, separation (mm).
    weights, offset : Array
        (m, 13) and (m,): |weights d - offset|^2 is what an error d costs, d of the shared quantities, then a small
        rotation vector (rad) and a translation (mm), both in the source frame and applied on the left.
    """

    source_from_guide: Array
    shared: Array
    weights: Array
    offset: Array


@dataclass(frozen=True, slots=True, eq=False)
class SharedPrior:
    """What the device files say of the seven shared quantities: costs |weights (shared - values)|^2."""

    values: Array
    weights: Array


def sightings(registrations: Sequence[Registration]) -> tuple[tuple[Sighting, ...], SharedPrior]:
    """One sighting for each registration by contour, in the first one's grid, and the files' share of them all.

    Raises
    ------
    ValueError
        If a registration is not by contour.
    """
    first = registrations[0]
    seen = tuple(_sighting(first, one) for one in registrations)
    rows, pulls = _prior(first, first.view(), _dimensions(first))
    weights = rows[:, _SHARED]
    values = seen[0].shared - np.linalg.solve(weights, pulls)
    return seen, SharedPrior(values, weights)


def _sighting(first: Registration, one: Registration) -> Sighting:
    """An error d costs d^T (C^-1 - R^T R) d - 2 d^T R^T p, R and p the rows and pulls of the prior."""
    dimensions = _dimensions(one)
    view = similarity_between(first.distortion, one.distortion).view(one.view())
    rows, pulls = _prior(one, one.view(), dimensions)
    information = _inverse(joint_covariance(one.covariance, dimensions)) - rows.T @ rows
    order = [*_SHARED, *_POSE]
    weights, offset = _whitened(information[np.ix_(order, order)], (rows.T @ pulls)[order])
    numbers = view.intrinsics
    shared = np.array([numbers.alpha_x_px, numbers.alpha_y_px, numbers.u0_px, numbers.v0_px, *dimensions.values_mm])
    return Sighting(view.source_from_guide, shared, weights, offset)


def _inverse(covariance: Array) -> Array:
    """The inverse, taken of the correlations: pixels, millimetres and radians side by side would cost digits."""
    sd = np.sqrt(np.diag(covariance))
    scales = np.outer(sd, sd)
    return np.asarray(np.linalg.inv(covariance / scales) / scales)


def _whitened(information: Array, slope: Array) -> tuple[Array, Array]:
    """W and w with |W d - w|^2 = d^T information d - 2 d^T slope besides a constant, where anything is known."""
    scale = 1.0 / np.sqrt(np.maximum(np.diag(information), np.finfo(np.float64).tiny))
    values, vectors = np.linalg.eigh(information * np.outer(scale, scale))
    known = values > _KNOWN * values[-1]
    roots = np.sqrt(values[known])
    basis = vectors[:, known]
    return roots[:, None] * (basis / scale[:, None]).T, (basis.T @ (slope * scale)) / roots


def _prior(one: Registration, view: View, dimensions: FittedDimensions) -> tuple[Array, Array]:
    """Rows (7, 13) and pulls (7,) of the device files at an estimate."""
    image = one.image
    nominal = nominal_intrinsics(one.carm, image.rows, image.columns, one.distortion.pixel_size_mm)
    priors = Priors.of(one.carm, one.guide, nominal)
    guide = with_dimensions(one.guide, *map(float, dimensions.values_mm))
    return priors.rows(), np.array(list(priors.pulls(view, guide).values()))


def _dimensions(registration: Registration) -> FittedDimensions:
    if registration.dimensions is None:
        raise ValueError("only registrations by contour can be taken together")
    return registration.dimensions

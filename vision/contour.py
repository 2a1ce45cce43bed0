"""The contour registration: all places on the wires against the projected model, by robust least squares.

Free are four intrinsics, the pose and the guide's three dimensions; weak priors hold the intrinsics to the C-arm file,
the dimensions to the guide file's tolerances. The distortion map's error is free too, held by the plate's balls; being
linear it is eliminated: it joins the noise's covariance. Symbols and gates: docs/method.md.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vision.devices import Guide
from vision.distortion import DistortionMap, PlateFit
from vision.priors import Priors
from vision.projection import View
from vision.strain import Strain, strain
from vision.view_fit import Observations, Places, solve_view
from vision.wire_noise import SHARED_OVER, Neighbours, PlaceCovariance, WireNoise

Array = NDArray[np.float64]

_TUKEY = 4.685  # standard deviations beyond which an observation has no weight; 95 % efficient on clean data
_LEAST_WEIGHT = 1e-6  # so that a place without weight keeps a finite variance
_FIRST_NOISE_PX = 0.3
_REWEIGHTINGS, _ROUGH_REWEIGHTINGS, _LATER_REWEIGHTINGS = 4, 2, 2  # the last where earlier weights are known


@dataclass(frozen=True, slots=True, eq=False)
class ContourFit:
    """The solution.

    Attributes
    ----------
    guide : Guide
        With the dimensions as the fit has them.
    residual_px : Array
        (n,) along the normals, under the corrected map.
    weight : Array
        (n,) robust weight, 0 to 1.
    noise_px : float
        Robust standard deviation of one place.
    pulls_sd : dict[str, float]
        Of each prior, in its standard deviations.
    strain : Strain
        What these pulls mean.
    covariance : Array
        (13, 13): the ten of `Registration.covariance`, then small radius, big radius, separation (mm).
    map : DistortionMap
        The plate's, corrected by what the wires tell of it.
    """

    view: View
    guide: Guide
    residual_px: Array
    weight: Array
    noise_px: float
    pulls_sd: dict[str, float]
    strain: Strain
    covariance: Array
    map: DistortionMap


def fit_contour(
    view: View,
    guide: Guide,
    observations: Observations,
    priors: Priors,
    plate: PlateFit,
    before: "ContourFit | None" = None,
) -> ContourFit:
    """Solve for the view.

    Parameters
    ----------
    view, guide
        Where to start.
    observations : Observations
        From the image.
    priors : Priors
        From the device files.
    plate : PlateFit
        The distortion map and its uncertainty, which all observations share.
    before : ContourFit or None
        An earlier fit to the same places on the wires: what it tells of their worth is the start.

    Returns
    -------
    ContourFit
        With covariance; nothing here is judged.
    """
    places, bend = Places.of(observations), _Bend.of(observations, plate)
    found = _reweighted(view, guide, places, priors, bend, _LATER_REWEIGHTINGS if before else _REWEIGHTINGS, before)
    view, guide, covariance = found.view, found.guide, found.covariance
    inverse = np.asarray(np.linalg.inv(places.information(view, guide, priors, covariance)), dtype=np.float64)
    pulls_sd = priors.pulls(view, guide)
    return ContourFit(
        view=view,
        guide=guide,
        residual_px=found.residual_px,
        weight=found.weight,
        noise_px=float(np.median(found.noise.sd_px)),
        pulls_sd=pulls_sd,
        strain=strain(pulls_sd, priors.rows(), inverse),
        covariance=inverse,
        map=bend.corrected(plate.map, places.residual_px(view, guide), covariance),
    )


def fit_roughly(view: View, guide: Guide, observations: Observations, priors: Priors) -> tuple[View, Guide]:
    """The view to some tenths of a pixel, from some pixels away: as `fit_contour` does, the map taken for exact."""
    places, nothing = Places.of(observations), np.zeros((len(observations.along), 0))
    found = _reweighted(view, guide, places, priors, _Bend(nothing.T, nothing), _ROUGH_REWEIGHTINGS)
    return found.view, found.guide


@dataclass(frozen=True, slots=True, eq=False)
class _Reweighted:
    """A view, what it leaves of the places (n,), px, their weights (n,), their noise and their covariance by these."""

    view: View
    guide: Guide
    residual_px: Array
    weight: Array
    noise: WireNoise
    covariance: PlaceCovariance


def _reweighted(
    view: View,
    guide: Guide,
    places: Places,
    priors: Priors,
    bend: "_Bend",
    reweightings: int,
    before: ContourFit | None = None,
) -> _Reweighted:
    """Solutions in turn with what they tell of each place's worth, which an earlier one may have told."""
    observations = places.observations
    width_px = guide.wire_diameter_mm * view.intrinsics.alpha_x_px / float(view.source_from_guide[2, 3])
    neighbours = Neighbours.of(observations.wire, observations.measured, SHARED_OVER * width_px)
    weight, residual = np.ones(len(observations.along)), np.zeros(len(observations.along))
    noise = WireNoise(np.full(len(weight), _FIRST_NOISE_PX), 0.0)
    if before is not None:
        weight, residual = before.weight, before.residual_px
        noise = WireNoise.measured(residual, observations.sd_px, weight > 0.0, neighbours)
    covariance = PlaceCovariance.of(noise, neighbours, np.maximum(weight, _LEAST_WEIGHT), bend.root)
    for _ in range(reweightings):
        view, guide = solve_view(view, guide, places, priors, covariance)
        residual = bend.corrected_residual(places.residual_px(view, guide), covariance)
        noise = WireNoise.measured(residual, observations.sd_px, weight > 0.0, neighbours)
        weight = np.clip(1.0 - residual**2 / (_TUKEY * noise.sd_px) ** 2, 0.0, None) ** 2
        covariance = PlaceCovariance.of(noise, neighbours, np.maximum(weight, _LEAST_WEIGHT), bend.root)
    return _Reweighted(view, guide, residual, weight, noise, covariance)


@dataclass(frozen=True, slots=True, eq=False)
class _Bend:
    """The distortion map's error at the places.

    Attributes
    ----------
    by_coefficient : Array
        (2 m, n): along the normals, by the coefficients of u, then those of v, times their covariance.
    root : Array
        (n, 2 m): a root of its covariance along the normals, px.
    """

    by_coefficient: Array
    root: Array

    @classmethod
    def of(cls, observations: Observations, plate: PlateFit) -> "_Bend":
        basis = plate.map.basis(plate.map.raw_from_corrected(observations.measured))
        along_u, along_v = (observations.normals[:, axis, None] for axis in (0, 1))
        held, root = basis @ plate.coefficient_covariance, basis @ plate.coefficient_root
        return cls(np.hstack((along_u * held, along_v * held)).T, np.hstack((along_u * root, along_v * root)))

    def corrected_residual(self, residual: Array, covariance: PlaceCovariance) -> Array:
        """The residuals (n,) without the error that they show."""
        return np.asarray(residual - self.root @ (self.root.T @ covariance.solved(residual[:, None])[:, 0]))

    def corrected(self, distortion: DistortionMap, residual: Array, covariance: PlaceCovariance) -> DistortionMap:
        """The map without the error that the residuals (n,) show."""
        error = (self.by_coefficient @ covariance.solved(residual[:, None])).reshape(2, -1)
        return replace(distortion, coefficients=distortion.coefficients - error.T)

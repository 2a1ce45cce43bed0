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
from vision.view_fit import Observations, design, residual_px, solve_view
from vision.wire_noise import SHARED_OVER, Whitening, WireNoise, nearness

Array = NDArray[np.float64]

_TUKEY = 4.685  # standard deviations beyond which an observation has no weight; 95 % efficient on clean data
_LEAST_WEIGHT = 1e-6  # so that a place without weight keeps a finite variance
_FIRST_NOISE = WireNoise(own_px=0.3, shared_px=0.0)
_REWEIGHTINGS = 4


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
    correlation : float
        Factor of a mean's variance that neighbours' common error makes.
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
    correlation: float
    pulls_sd: dict[str, float]
    strain: Strain
    covariance: Array
    map: DistortionMap


def fit_contour(view: View, guide: Guide, observations: Observations, priors: Priors, plate: PlateFit) -> ContourFit:
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

    Returns
    -------
    ContourFit
        With covariance; nothing here is judged.
    """
    width_px = guide.wire_diameter_mm * view.intrinsics.alpha_x_px / float(view.source_from_guide[2, 3])
    near = nearness(observations.wire, observations.measured, SHARED_OVER * width_px)
    bend = _Bend.of(observations, plate)
    weight, noise, residual = np.ones(len(observations.along)), _FIRST_NOISE, np.zeros(len(observations.along))
    for _ in range(_REWEIGHTINGS):
        whitened = Whitening.of(_covariance(observations, noise, near, weight) + bend.covariance)
        view, guide = solve_view(view, guide, observations, priors, whitened)
        residual = residual_px(view, guide, observations)
        residual = residual - bend.covariance @ whitened.solved(residual)
        noise = WireNoise.measured(residual, observations.sd_px, weight > 0.0, near)
        weight = np.clip(1.0 - residual**2 / (_TUKEY**2 * noise.variance(observations.sd_px)), 0.0, None) ** 2
    places = _covariance(observations, noise, near, weight)
    whitened = Whitening.of(places + bend.covariance)
    jacobian = design(view, guide, observations, priors, whitened)
    inverse = np.asarray(np.linalg.inv(jacobian.T @ jacobian), dtype=np.float64)
    pulls_sd, seen = priors.pulls(view, guide), weight > 0.0
    return ContourFit(
        view=view,
        guide=guide,
        residual_px=residual,
        weight=weight,
        noise_px=float(np.sqrt(np.median(noise.variance(observations.sd_px)))),
        correlation=float((noise.covariance(observations.sd_px, near)[np.ix_(seen, seen)]).sum(axis=1).mean())
        / float(noise.variance(observations.sd_px)[seen].mean()),
        pulls_sd=pulls_sd,
        strain=strain(pulls_sd, priors.rows(), inverse),
        covariance=inverse,
        map=bend.corrected(plate.map, whitened.solved(residual_px(view, guide, observations))),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Bend:
    """The distortion map's error at the places: its effect (n, m) by axis, and its covariance with the coefficients'.

    Attributes
    ----------
    by_coefficient : Array
        (n, 2, m): along the normals, by the coefficients of u and of v, times their covariance.
    covariance : Array
        (n, n), px^2, along the normals.
    """

    by_coefficient: Array
    covariance: Array

    @classmethod
    def of(cls, observations: Observations, plate: PlateFit) -> "_Bend":
        basis = plate.map.basis(plate.map.raw_from_corrected(observations.measured))
        held = basis @ plate.coefficient_covariance
        covariance = (observations.normals @ observations.normals.T) * (held @ basis.T)
        return cls(observations.normals[:, :, None] * held[:, None, :], covariance)

    def corrected(self, distortion: DistortionMap, strain: Array) -> DistortionMap:
        """The map without the error that the residuals show; `strain` is the inverse covariance times residuals."""
        error = np.einsum("nam,n->ma", self.by_coefficient, strain)
        return replace(distortion, coefficients=distortion.coefficients - error)


def _covariance(observations: Observations, noise: WireNoise, near: Array, weight: Array) -> Array:
    """Covariance (n, n) of the places' own errors, px^2, those of little weight taken for noisier."""
    root = np.sqrt(np.maximum(weight, _LEAST_WEIGHT))
    return np.asarray(noise.covariance(observations.sd_px, near) / np.outer(root, root))

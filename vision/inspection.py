"""What an image was found to show, as data for a picture: balls, rings, views of the guide, residuals, the aim."""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import RectBivariateSpline

from vision.absorption import absorption
from vision.alignment import check_depth, goal, target_in_source
from vision.contour import ContourFit
from vision.corrected_image import CorrectedImage
from vision.detection import RingCandidate
from vision.devices import CArm, Guide
from vision.distortion import DistortionMap, FittedBalls
from vision.findings import Findings
from vision.line_ends import LineEnd
from vision.plate import ball_spots
from vision.projection import View, project
from vision.refusal import Refusal
from vision.registered import DEFAULT_DEPTH_MM, PixelSpace, PredictedError, Registration
from vision.search import Search
from vision.solution import Attempt, Solution
from vision.targeting import locate
from vision.uncertainty import aim_covariance, radius_95
from vision.view_fit import Observations
from vision.wire_model import WireSamples, points_in_guide, sample_wires
from vision.xray import XrayImage

Array = NDArray[np.float64]

_COARSE = 64  # places a side at which the distortion is inverted for the picture


@dataclass(frozen=True, slots=True, eq=False)
class WireResiduals:
    """Ridge points against the wires of a view.

    Attributes
    ----------
    wire, along
        (n,) each: places on the wires, as in `WireSamples`.
    model : Array
        (n, 2), corrected pixels: where the view puts them.
    normals : Array
        (n, 2), unit.
    residual_px : Array
        (n,): measured minus model along the normal.
    weight : Array
        (n,) of the robust fit, 0 to 1.
    """

    wire: NDArray[np.intp]
    along: Array
    model: Array
    normals: Array
    residual_px: Array
    weight: Array


@dataclass(frozen=True, slots=True, eq=False)
class FoundView:
    """One view of the guide that was tried, corrected pixels; `residuals` is None where it was never fitted."""

    view: View
    guide: Guide
    wires: WireSamples
    residuals: WireResiduals | None
    line_ends: list[LineEnd]
    bead_px: Array | None


@dataclass(frozen=True, slots=True, eq=False)
class Aim:
    """A target, corrected pixel (2,); the covariance (2, 2), px^2, of where the axis passes it; the bounds."""

    pixel: Array
    covariance_px2: Array
    bounds_95: PredictedError


@dataclass(frozen=True, slots=True, eq=False)
class Inspection:
    """All that a picture shows.

    Attributes
    ----------
    pixels : NDArray[np.float32]
        (rows, columns), on the corrected grid where there is one.
    spots : Array
        (n, 2), raw pixels: what may be balls, where no plate came of them.
    balls : FittedBalls or None
        Of the plate.
    rings, views
        Candidates, and the views of the guide that were tried on them.
    aim : Aim or Refusal or None
        None where there is no registration.
    """

    pixels: NDArray[np.float32]
    result: Registration | Refusal
    spots: Array
    balls: FittedBalls | None
    rings: list[RingCandidate]
    views: list[FoundView]
    aim: Aim | Refusal | None


def inspect(
    image: XrayImage,
    guide: Guide,
    carm: CArm,
    findings: Findings,
    target: tuple[float, float] | None = None,
    space: PixelSpace = PixelSpace.RAW,
    depth_mm: float = DEFAULT_DEPTH_MM,
) -> Inspection:
    """What to look at.

    Parameters
    ----------
    image, guide, carm
        As they were registered.
    findings : Findings
        Of `registration.examine`.
    target : tuple or None
        (u, v) in `space`; without it the aim is at the small ring's centre.
    space : PixelSpace
        Grid of the target.
    depth_mm : float
        Depth of the target below the big ring.

    Returns
    -------
    Inspection
        Of a refused image: as far as it came.
    """
    corrected, search, result = findings.corrected, findings.search, findings.result
    return Inspection(
        pixels=image.pixels if corrected is None else _on_corrected_grid(image.pixels, _map(result, corrected)),
        result=result,
        spots=_spots(image, carm) if corrected is None else np.zeros((0, 2)),
        balls=None if corrected is None else corrected.plate.balls,
        rings=[] if search is None else search.candidates.rings,
        views=[] if search is None else [_found(attempt, guide) for attempt in _shown(search)],
        aim=aim_at(result, target, space, depth_mm) if isinstance(result, Registration) else None,
    )


def _spots(image: XrayImage, carm: CArm) -> Array:
    if carm.plate is None:
        return np.zeros((0, 2))
    return ball_spots(absorption(image), carm.plate, carm.field_of_view_mm / max(image.rows, image.columns))


def _map(result: Registration | Refusal, corrected: CorrectedImage) -> DistortionMap:
    """The registration's, which the wires have a part in; of a refused image the plate's alone."""
    return result.distortion if isinstance(result, Registration) else corrected.plate.map


def _on_corrected_grid(pixels: NDArray[np.float32], distortion: DistortionMap) -> NDArray[np.float32]:
    """The image as it would be without distortion; the map is inverted on a coarse grid, for it bends slowly."""
    rows, columns = pixels.shape
    coarse_u, coarse_v = (np.linspace(0.0, size - 1.0, _COARSE) for size in (columns, rows))
    u, v = np.meshgrid(coarse_u, coarse_v)
    raw = distortion.raw_from_corrected(np.column_stack((u.ravel(), v.ravel()))).reshape(_COARSE, _COARSE, 2)
    fine = [
        RectBivariateSpline(coarse_v, coarse_u, raw[:, :, axis])(np.arange(rows), np.arange(columns)) for axis in (0, 1)
    ]
    raw_u, raw_v = (one.astype(np.float32) for one in fine)
    return np.asarray(cv2.remap(pixels, raw_u, raw_v, cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT))


def _shown(search: Search) -> list[Attempt]:
    """Those that passed; the one whose refusal was reported where none did."""
    return search.passed or search.attempts[:1]


def _found(attempt: Attempt, guide: Guide) -> FoundView:
    outcome, last = attempt.outcome, attempt.last
    if isinstance(outcome, Solution):
        bead_px = None if outcome.bead is None else outcome.bead.centre_px
        return _fitted(outcome.fit, outcome.observations, outcome.line_ends, bead_px)
    if last is not None:
        return _fitted(last.fit, last.measured.observations, last.line_ends, None)
    view = attempt.first.view
    return FoundView(view, guide, sample_wires(view, guide), None, [], None)


def _fitted(fit: ContourFit, observations: Observations, line_ends: list[LineEnd], bead_px: Array | None) -> FoundView:
    model = project(fit.view, points_in_guide(fit.guide, observations.wire, observations.along))
    residuals = WireResiduals(
        observations.wire, observations.along, model, observations.normals, fit.residual_px, fit.weight
    )
    return FoundView(fit.view, fit.guide, sample_wires(fit.view, fit.guide), residuals, line_ends, bead_px)


def aim_at(
    registration: Registration, target: tuple[float, float] | None, space: PixelSpace, depth_mm: float
) -> Aim | Refusal:
    """The aim at a pixel of `space`, at the small ring's centre without one."""
    pixel = registration.fiducials_px["small_centre"]
    view, guide = registration.view(), registration.guide
    if target is not None:
        picked = locate(registration, target, space)
        if isinstance(picked, Refusal):
            return picked
        pixel = picked.corrected
    refused = check_depth(view, guide, depth_mm)
    if refused is not None:
        return refused
    guide_from_goal, _ = goal(view, pixel)
    spread = aim_covariance(view, registration.covariance, guide, pixel, depth_mm, guide_from_goal)
    per_mm = view.intrinsics.alpha_x_px / float(target_in_source(view, pixel, guide, depth_mm)[2])
    bounds = PredictedError(radius_95(spread[:3, :3]), radius_95(spread[3:, 3:]), depth_mm)
    return Aim(pixel, per_mm**2 * spread[3:5, 3:5], bounds)

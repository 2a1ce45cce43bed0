"""From a first view to a judged one: measure the wires, fit, measure again; then bead, line ends and gates."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from vision import gates
from vision.bead import BeadEvidence, Crossing, locate_bead
from vision.bead_centre import BeadCentre, measure_bead
from vision.contour import ContourFit, fit_contour, fit_roughly
from vision.devices import Guide
from vision.first_pose import FirstView
from vision.line_ends import LineEnd, measure_line_ends
from vision.measuring import FAINTEST, Measured, Scene, bead_sd_px, find, measure, shadows_in, with_single_points
from vision.priors import VIEW_PARAMETERS
from vision.projection import View, project, projection_jacobian
from vision.refusal import Refusal
from vision.view_fit import Observations, Places
from vision.wire_model import sample_wires
from vision.wire_noise import LEAST_NOISE_PX

Array = NDArray[np.float64]

_ROUGH_ROUNDS = 2  # at most
_FAR_PX = 3.0  # from where it was looked for: a wire so far away is looked for once more
_LINEAR_PX = 0.2  # from where its pieces were cut: a shadow's shift is linear so far, to some thousandths of a pixel


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """A view that passed every gate but the predicted error's."""

    fit: ContourFit
    observations: Observations
    line_ends: list[LineEnd]
    bead: BeadEvidence | None


@dataclass(frozen=True, slots=True, eq=False)
class Round:
    """A fit, what it was fitted to, and how far it took the wires from where these were cut into pieces, px."""

    fit: ContourFit
    measured: Measured
    line_ends: list[LineEnd]
    moved_px: float


@dataclass(frozen=True, slots=True, eq=False)
class Attempt:
    """What became of a first view: the last round without bead, where it came to one, and the verdict."""

    first: FirstView
    last: Round | None
    outcome: Solution | Refusal


def solve(first: FirstView, scene: Scene) -> Attempt:
    """Refine a first view and judge it.

    Parameters
    ----------
    first : FirstView
        Within some pixels of the wires.
    scene : Scene
        The image's reader, plate and files.

    Returns
    -------
    Attempt
        Refused by the first gate that says no.
    """
    last = _refined(first, scene)
    if isinstance(last, Refusal):
        return Attempt(first, None, last)
    return Attempt(first, last, _judged_before_bead(last) or _with_bead(last, scene))


def _with_bead(last: Round, scene: Scene) -> Solution | Refusal:
    """The bead's verdict, and the final fit with its centre."""
    bead = _bead(last, scene)
    if isinstance(bead, Refusal):
        return bead
    evidence, centre = bead
    view, guide = last.fit.view, last.fit.guide
    far = last.moved_px > _LINEAR_PX
    measured = measure(view, guide, scene, last.measured.amplitude) if far else last.measured
    if isinstance(measured, Refusal):
        return measured
    observations = with_single_points(measured.observations, view, guide, last.line_ends, centre)
    fit = fit_contour(view, guide, observations, scene.priors, scene.plate, None if far else last.fit)
    refusal = (
        gates.check_residual(fit)
        or gates.check_explained(fit, observations)
        or gates.check_pulls(fit)
        or gates.check_trust(fit, scene.guide)
        or gates.check_tilt(fit.view)
    )
    return refusal or Solution(fit, _on_corrected_map(observations, fit, scene), last.line_ends, evidence)


def _on_corrected_map(observations: Observations, fit: ContourFit, scene: Scene) -> Observations:
    """The places by the map that the fit corrected."""
    raw = scene.plate.map.raw_from_corrected(observations.measured)
    return replace(observations, measured=fit.map.corrected_from_raw(raw))


def _refined(first: FirstView, scene: Scene) -> Round | Refusal:
    """Rings and line: roughly at first, then all there is to be seen; the line's ends where it then is."""
    view, guide, amplitude = first.view, scene.guide, 0.0
    for _ in range(_ROUGH_ROUNDS):
        found = find(view, guide, scene)
        if isinstance(found, Refusal):
            return found
        before, amplitude = (view, guide), found.amplitude
        view, guide = fit_roughly(view, guide, found.observations, scene.priors)
        if _moved_px(found.observations, before, (view, guide)) < _FAR_PX:
            break
    measured = measure(view, guide, scene, amplitude)
    if isinstance(measured, Refusal):
        return measured
    fit = fit_contour(view, guide, measured.observations, scene.priors, scene.plate)
    moved_px = _moved_px(measured.observations, (view, guide), (fit.view, fit.guide))
    return Round(fit, measured, _line_ends(fit.view, fit.guide, scene, measured.amplitude), moved_px)


def _line_ends(view: View, guide: Guide, scene: Scene, amplitude: float) -> list[LineEnd]:
    return measure_line_ends(view, guide, scene.plate.map, scene.values, shadows_in(scene, amplitude))


def _moved_px(observations: Observations, before: tuple[View, Guide], after: tuple[View, Guide]) -> float:
    """How far the farthest place on a wire has moved across it."""
    places = Places.of(observations)
    return float(np.abs(places.residual_px(*before) - places.residual_px(*after)).max())


def _judged_before_bead(last: Round) -> Refusal | None:
    fit, measured = last.fit, last.measured
    return (
        gates.check_coverage(fit, measured.observations, measured.places)
        or gates.check_line(fit, measured.observations, measured.places, last.line_ends)
        or gates.check_residual(fit)
        or gates.check_pulls(fit)
        or gates.check_line_ends(last.line_ends, FAINTEST * measured.amplitude)
        or gates.check_tilt(fit.view)
    )


def _bead(last: Round, scene: Scene) -> tuple[BeadEvidence, BeadCentre] | tuple[None, None] | Refusal:
    """Handedness, and the bead's distance from its prediction in standard deviations."""
    guide, fit = scene.guide, last.fit
    if guide.bead is None:
        return None, None
    crossing = Crossing(sample_wires(fit.view, fit.guide).points, scene.balls)
    per_mm = last.measured.amplitude / guide.wire_diameter_mm
    evidence = locate_bead(fit.view, guide.bead, per_mm, scene.reader, crossing)
    if isinstance(evidence, Refusal):
        return evidence
    shadows = shadows_in(scene, last.measured.amplitude)
    structure = fit.noise_px / max(float(np.median(last.measured.observations.sd_px)), LEAST_NOISE_PX)
    centre = measure_bead(fit.view, fit.guide, evidence.centre_px, scene.plate.map, scene.values, shadows, structure)
    place = np.array(guide.bead.position_mm)
    excess = centre.centre_px - project(fit.view, place[None])[0]
    spread = _prediction_covariance(fit, place) + bead_sd_px(fit.view, guide, centre) ** 2 * np.eye(2)
    refusal = gates.check_bead(float(np.sqrt(excess @ np.linalg.solve(spread, excess))))
    return refusal or (replace(evidence, centre_px=centre.centre_px), centre)


def _prediction_covariance(fit: ContourFit, place: Array) -> Array:
    """Covariance (2, 2), px^2, of a guide point's projection by the fit's ten view parameters."""
    jacobian = projection_jacobian(fit.view, np.tile(place, (2, 1)), np.eye(2))
    return np.asarray(jacobian @ fit.covariance[:VIEW_PARAMETERS, :VIEW_PARAMETERS] @ jacobian.T)

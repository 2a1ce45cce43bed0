"""From a first view to a judged one: measure the wires, fit, measure again; then bead, line ends and gates."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial import KDTree

from vision import gates
from vision.bead import BeadEvidence, Crossing, locate_bead
from vision.contour import ContourFit, Observations, Priors, fit_contour
from vision.devices import Guide
from vision.distortion import PlateFit
from vision.first_pose import FirstView
from vision.line_ends import LineEnd, measure_line_ends
from vision.profiles import ProfileReader
from vision.projection import View, project
from vision.refusal import Refusal, RefusalCode
from vision.wire_model import Wire, WireSamples, sample_wires

Array = NDArray[np.float64]

_ROUNDS = 3  # without bead; measuring and fitting have converged to a hundredth of a pixel by then
_BEAD_SD_PX = 0.15  # of its centre: a spot of some 12 px across on structured ground
_LINE_END_SD_PX = 0.3  # of the place of half absorption
_FAINTEST, _STRONGEST = 0.35, 3.0  # amplitude of an accepted profile, of the median
_WORST_MISFIT = 0.5  # of its amplitude
_FARTHEST = 0.8  # of the profile's reach: beyond it the crest found is another's
_BALL_MARGIN = 0.8  # of the profile's reach, kept free around a ball


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """What all candidates of one image share; `balls` (m, 3) corrected pixel and radius, px."""

    guide: Guide
    priors: Priors
    plate: PlateFit
    reader: ProfileReader
    balls: Array


@dataclass(frozen=True, slots=True, eq=False)
class Solution:
    """A view that passed every gate but the predicted error's."""

    fit: ContourFit
    observations: Observations
    line_ends: list[LineEnd]
    bead: BeadEvidence | None


def solve(first: FirstView, scene: Scene) -> Solution | Refusal:
    """Refine a first view and judge it.

    Parameters
    ----------
    first : FirstView
        Within some pixels of the wires.
    scene : Scene
        The image's reader, plate and files.

    Returns
    -------
    Solution or Refusal
        The first gate that says no.
    """
    view, guide = first.view, scene.guide
    ends: list[LineEnd] = []
    for _ in range(_ROUNDS):
        observations, samples, amplitude = _observe(view, guide, scene, ends, None)
        if isinstance(observations, Refusal):
            return observations
        fit = fit_contour(view, guide, observations, scene.priors, scene.plate)
        view, guide = fit.view, fit.guide
        samples = sample_wires(view, guide)
        ends = measure_line_ends(view, guide, scene.reader, samples, scene.balls)
    refusal = _judged_before_bead(fit, observations, samples, ends, amplitude)
    if refusal is not None:
        return refusal
    bead = _bead(fit, samples, amplitude, scene)
    if isinstance(bead, Refusal):
        return bead
    observations, _, _ = _observe(view, guide, scene, ends, bead)
    if isinstance(observations, Refusal):
        return observations
    fit = fit_contour(view, guide, observations, scene.priors, scene.plate)
    refusal = gates.check_residual(fit) or gates.check_pulls(fit) or gates.check_tilt(fit.view)
    return refusal or Solution(fit, observations, ends, bead)


def _judged_before_bead(
    fit: ContourFit, observations: Observations, samples: WireSamples, ends: list[LineEnd], amplitude: float
) -> Refusal | None:
    sampled = int((samples.wire == Wire.LINE).sum())
    return (
        gates.check_coverage(fit, observations)
        or gates.check_line(fit, observations, sampled)
        or gates.check_residual(fit)
        or gates.check_pulls(fit)
        or gates.check_line_ends(ends, amplitude, _FAINTEST)
        or gates.check_tilt(fit.view)
    )


def _observe(
    view: View, guide: Guide, scene: Scene, ends: list[LineEnd], bead: BeadEvidence | None
) -> tuple[Observations | Refusal, WireSamples, float]:
    """Profiles along all wires where nothing crosses them, those that look like a wire's; and their amplitude."""
    samples = sample_wires(view, guide)
    samples = samples.chosen(_uncrossed(samples, scene))
    if len(samples.along) < 100:
        message = "places on the wires that can be measured"
        return Refusal(RefusalCode.NO_GUIDE_FOUND, message, len(samples.along), 100), samples, 0.0
    profiles = scene.reader.read(samples.points, samples.normals)
    amplitude = float(np.median(profiles.amplitude[samples.wire != Wire.LINE]))
    good = (
        (profiles.amplitude > _FAINTEST * amplitude)
        & (profiles.amplitude < _STRONGEST * amplitude)
        & (profiles.misfit < _WORST_MISFIT * profiles.amplitude)
        & (np.abs(profiles.offset_px) < _FARTHEST * scene.reader.reach_px)
    )
    if good.sum() < 100:
        message = "places on the wires that look like a wire"
        return Refusal(RefusalCode.NO_GUIDE_FOUND, message, float(good.sum()), 100), samples, amplitude
    chosen = samples.chosen(good)
    measured = chosen.points + profiles.offset_px[good, None] * chosen.normals
    extra = _single_points(view, guide, ends, bead, scene)
    return Observations(chosen.wire, chosen.along, measured, chosen.normals, *extra), samples, amplitude


def _uncrossed(samples: WireSamples, scene: Scene) -> NDArray[np.bool_]:
    """Which samples no other wire and no ball disturbs."""
    free = np.ones(len(samples.along), dtype=bool)
    for wire in Wire:
        on = samples.wire == wire
        distance, _ = KDTree(samples.points[~on]).query(samples.points[on])
        free[on] = distance > scene.reader.reach_px + 2.0 * scene.reader.crest_sd_px
    if len(scene.balls):
        distance, index = KDTree(scene.balls[:, :2]).query(samples.points)
        free &= distance > scene.balls[index, 2] + _BALL_MARGIN * scene.reader.reach_px
    return free


def _single_points(
    view: View, guide: Guide, ends: list[LineEnd], bead: BeadEvidence | None, scene: Scene
) -> tuple[Array, Array, Array, Array]:
    """Line ends along the line, the bead's centre along u and v: places mm, pixels, directions, sd px."""
    places, measured, normals, sd = [], [], [], []
    for end in ends:
        place = np.array([end.x_mm, 0.0, 0.0])
        outwards = _outwards(view, guide, end.x_mm)
        places.append(place)
        measured.append(project(view, place[None])[0] + end.excess_px * outwards)
        normals.append(outwards)
        sd.append(_LINE_END_SD_PX)
    if bead is not None and guide.bead is not None:
        for direction in np.eye(2):
            places.append(np.array(guide.bead.position_mm))
            measured.append(bead.centre_px)
            normals.append(direction)
            sd.append(bead_sd_px(view, guide))
    shape = (len(sd), 3), (len(sd), 2), (len(sd), 2), (len(sd),)
    arrays = (
        np.array(values, dtype=np.float64).reshape(s)
        for values, s in zip((places, measured, normals, sd), shape, strict=True)
    )
    return tuple(arrays)  # type: ignore[return-value]  # four arrays, by construction


def _outwards(view: View, guide: Guide, x_mm: float) -> Array:
    start, end = project(view, np.array([[guide.line_start_mm, 0.0, 0.0], [guide.line_end_mm, 0.0, 0.0]]))
    along = (end - start) / np.linalg.norm(end - start)
    return np.asarray(along if x_mm == guide.line_end_mm else -along)


def bead_sd_px(view: View, guide: Guide) -> float:
    """Standard deviation of the bead's centre: measurement and manufacture, px."""
    if guide.bead is None:
        return _BEAD_SD_PX
    per_mm = view.intrinsics.alpha_x_px / float(view.source_from_guide[2, 3])
    return float(np.hypot(_BEAD_SD_PX, guide.tolerance.bead_sd_mm * per_mm))


def _bead(fit: ContourFit, samples: WireSamples, amplitude: float, scene: Scene) -> BeadEvidence | Refusal | None:
    """Handedness, and the bead's distance from its prediction in standard deviations."""
    guide = scene.guide
    if guide.bead is None:
        return None
    crossing = Crossing(samples.points, scene.balls)
    evidence = locate_bead(fit.view, guide.bead, amplitude / guide.wire_diameter_mm, scene.reader, crossing)
    if isinstance(evidence, Refusal):
        return evidence
    place = np.array(guide.bead.position_mm)
    excess = evidence.centre_px - project(fit.view, place[None])[0]
    spread = _prediction_covariance(fit, place) + bead_sd_px(fit.view, guide) ** 2 * np.eye(2)
    refusal = gates.check_bead(float(np.sqrt(excess @ np.linalg.solve(spread, excess))))
    return refusal or evidence


def _prediction_covariance(fit: ContourFit, place: Array) -> Array:
    """Covariance (2, 2), px^2, of a guide point's projection by the fit's ten view parameters."""
    intrinsics, pose = fit.view.intrinsics, fit.view.source_from_guide
    turned = pose[:3, :3] @ place
    x, y, z = turned + pose[:3, 3]
    by_point = np.array(
        [
            [intrinsics.alpha_x_px / z, 0.0, -intrinsics.alpha_x_px * x / z**2],
            [0.0, intrinsics.alpha_y_px / z, -intrinsics.alpha_y_px * y / z**2],
        ]
    )
    cross = np.array([[0.0, turned[2], -turned[1]], [-turned[2], 0.0, turned[0]], [turned[1], -turned[0], 0.0]])
    by_intrinsics = np.array([[x / z, 0.0, 1.0, 0.0], [0.0, y / z, 0.0, 1.0]])
    jacobian = np.hstack((by_intrinsics, by_point @ cross, by_point))
    return np.asarray(jacobian @ fit.covariance[:10, :10] @ jacobian.T)

"""The gates of a registration: each measures one thing and refuses beyond its limit (H05, H06, H07)."""

import math

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2, norm

from vision.alignment import goal
from vision.contour import ContourFit
from vision.devices import Guide
from vision.line_ends import LineEnd
from vision.priors import VIEW_PARAMETERS
from vision.projection import View, project
from vision.refusal import Refusal, RefusalCode
from vision.registered import DEFAULT_DEPTH_MM, PredictedError
from vision.strain import Strain
from vision.uncertainty import freed_errors
from vision.view_fit import Observations
from vision.wire_model import Wire, WireSamples

Array = NDArray[np.float64]

GREATEST_RESIDUAL_PX = 0.6  # robust noise of a ridge point; a good image has 0.1, and 0.6 still aims within 0.1 deg
FALSE_REFUSAL = 1e-4  # probability, for each test of the device files, that files which are right fail it
GREATEST_PULL_SD = float(norm.isf(FALSE_REFUSAL / 2.0))  # of one quantity, over the spread that its pull should have
GREATEST_TILT_RAD = math.radians(45.0)
LEAST_RING_COVERAGE = 0.5  # of the directions about a ring's centre that hold accepted points
GREATEST_UNEXPLAINED = 3.0  # root mean square of a ring's residuals over what is expected of them; good images: 1.2
STRUCTURE_PX = 0.05  # what bone and crossings leave of a place, however little noise its pixels have
LEAST_LINE_COVERAGE = 0.4
LEAST_LINE_ENDS = 1  # an edge of bone may be as long and as straight as the line; it does not end where the line does
GREATEST_GAP_RAD = math.radians(100.0)  # of a ring, though nothing known covers it: less than 260 deg hold it loosely
GREATEST_BEAD_SD = math.sqrt(chi2.isf(FALSE_REFUSAL, 2))
GREATEST_SCALE_OFF = 0.06  # relative: the plate's pixel size against the C-arm file's; distances of plate and SID
GREATEST_TOLD_SCALE_OFF = 0.01  # relative, of a panel: fields of view are told to the millimetre, of 100 mm or more
WRONG_RAD, WRONG_MM = math.radians(0.5), 1.0  # what counts as a wrong registration
GREATEST_PREDICTED_RAD, GREATEST_PREDICTED_MM = WRONG_RAD / 2.0, WRONG_MM / 2.0
_AIMS_MM = 40.0 * np.array([[0.0, 0.0], [1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])  # as far as guides are moved
_SECTORS = 72


def check_scale(fitted_mm: float, file_mm: float) -> Refusal | None:
    """H06: the pixel size that the plate shows against the C-arm file's."""
    off = abs(fitted_mm / file_mm - 1.0)
    if not off <= GREATEST_SCALE_OFF:
        message = "the pixel size by the plate contradicts the C-arm file (relative)"
        return Refusal(RefusalCode.SCALE_MISMATCH, message, off, GREATEST_SCALE_OFF)
    return None


def check_told_scale(told_mm: float, file_mm: float, greatest_off: float) -> Refusal | None:
    """H06: the pixel size that the image's own header tells against the C-arm file's."""
    off = abs(told_mm / file_mm - 1.0)
    if not off <= greatest_off:
        message = "the pixel size that the image's header tells contradicts the C-arm file (relative)"
        return Refusal(RefusalCode.SCALE_MISMATCH, message, off, greatest_off)
    return None


def check_residual(fit: ContourFit) -> Refusal | None:
    """The noise of the accepted points about the model, px."""
    if not fit.noise_px <= GREATEST_RESIDUAL_PX:
        message = "ridge points scatter about the fitted wires (px)"
        return Refusal(RefusalCode.RESIDUAL_TOO_HIGH, message, fit.noise_px, GREATEST_RESIDUAL_PX)
    return None


def check_explained(fit: ContourFit, observations: Observations) -> Refusal | None:
    """What a ring's places leave must be about what noise and structure leave: else the model does not hold.

    A map that rests on too few balls, or on wrong ones, bends all wires smoothly, by far more than it promises.
    """
    for wire, name in ((Wire.SMALL_RING, "small ring"), (Wire.BIG_RING, "big ring")):
        on = (observations.wire == wire) & (fit.weight > 0.0)
        expected_px = np.hypot(observations.sd_px[on], STRUCTURE_PX)
        unexplained = float(np.sqrt(np.mean((fit.residual_px[on] / expected_px) ** 2)))
        if not unexplained <= GREATEST_UNEXPLAINED:
            message = f"what the {name}'s places leave, over what noise and structure explain"
            return Refusal(RefusalCode.RESIDUAL_TOO_HIGH, message, unexplained, GREATEST_UNEXPLAINED)
    return None


def check_pulls(fit: ContourFit) -> Refusal | None:
    """No prior may be strained, alone or with the others: guide and C-arm are those of the files."""
    strain = fit.strain
    worst = int(np.argmax(np.abs(strain.deviations)))
    deviation = abs(float(strain.deviations[worst]))
    if not deviation <= GREATEST_PULL_SD:
        message = f"the image contradicts the device files: {strain.names[worst]} is off (standard deviations)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, deviation, GREATEST_PULL_SD)
    greatest = float(chi2.isf(FALSE_REFUSAL, max(strain.freedom, 1)))
    if not strain.joint <= greatest:
        message = f"the image contradicts the device files together (chi-square of {strain.freedom} degrees of freedom)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, strain.joint, greatest)
    return None


def check_trust(fit: ContourFit, guide: Guide) -> Refusal | None:
    """No single quantity of the files may make an aim wrong, of targets about as far away as guides are moved.

    The aim is computed once more without trust in each of them. A wrong dimension that the pulls do not yet show, as a
    ring separation 5 % off, moves the aim by what it would cost.
    """
    pixels = project(fit.view, np.column_stack((_AIMS_MM, np.zeros(len(_AIMS_MM)))))
    freed = _freed(fit.view, fit.strain, guide, pixels, DEFAULT_DEPTH_MM)
    return _check_freed(fit.strain, np.max(freed, axis=0), (WRONG_RAD, WRONG_MM))


def check_trust_at(
    view: View, strain: Strain, guide: Guide, pixel: Array, depth_mm: float, guide_from_axis: Array | None = None
) -> Refusal | None:
    """The same at a target's own pixel (2,) and depth, where half of that is too much.

    What the image makes of a quantity scatters about the truth, so half-way between right and wrong both mistakes are
    equally rare: to refuse right files, and to accept ones that make the aim wrong. With an axis (4, 4) given it is not
    the aim that is judged, but what is told of that axis.
    """
    freed = _freed(view, strain, guide, pixel, depth_mm, guide_from_axis)
    return _check_freed(strain, freed, (GREATEST_PREDICTED_RAD, GREATEST_PREDICTED_MM))


def _freed(
    view: View, strain: Strain, guide: Guide, pixels: Array, depth_mm: float, guide_from_axis: Array | None = None
) -> Array:
    """By how much aims at pixels (..., 2), or an axis's errors, change without trust in each of k quantities.

    In rad and mm, (..., k, 2).
    """
    axes = goal(view, pixels)[0] if guide_from_axis is None else guide_from_axis
    return freed_errors(view, strain.freed_steps[:, :VIEW_PARAMETERS], guide, pixels, depth_mm, axes)


def _check_freed(strain: Strain, freed: Array, limits: tuple[float, float]) -> Refusal | None:
    greatest_rad, greatest_mm = limits
    for name, (angle_rad, position_mm) in zip(strain.names, freed.tolist(), strict=True):
        if not angle_rad <= greatest_rad:
            message = f"the aim hangs on the file's {name}: without it, it turns (deg)"
            return Refusal(RefusalCode.GUIDE_MISMATCH, message, math.degrees(angle_rad), math.degrees(greatest_rad))
        if not position_mm <= greatest_mm:
            message = f"the aim hangs on the file's {name}: without it, it moves (mm)"
            return Refusal(RefusalCode.GUIDE_MISMATCH, message, position_mm, greatest_mm)
    return None


def check_tilt(view: View) -> Refusal | None:
    """The guide's axis against the ray through the small ring's centre."""
    pose = view.source_from_guide
    cosine = float(pose[:3, 2] @ pose[:3, 3] / np.linalg.norm(pose[:3, 3]))
    tilt_rad = float(np.arccos(np.clip(cosine, -1.0, 1.0)))
    if not tilt_rad <= GREATEST_TILT_RAD:
        message = "the guide's axis is too far from the beam (deg)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, math.degrees(tilt_rad), math.degrees(GREATEST_TILT_RAD))
    return None


def check_coverage(fit: ContourFit, observations: Observations, places: WireSamples) -> Refusal | None:
    """Accepted points all around both rings; what another wire or a ball of the model covers is nobody's fault."""
    for wire, name in ((Wire.SMALL_RING, "small ring"), (Wire.BIG_RING, "big ring")):
        seen = _sectors(observations.along[(observations.wire == wire) & (fit.weight > 0.0)])
        share = float(seen.mean())
        if share < LEAST_RING_COVERAGE:
            message = f"share of the {name} that is seen"
            return Refusal(RefusalCode.RING_MISSING, message, share, LEAST_RING_COVERAGE)
        gap_rad = _longest_gap(seen, _sectors(places.along[places.wire == wire]) & ~seen)
        if gap_rad > GREATEST_GAP_RAD:
            message = f"longest unseen arc of the {name} (deg)"
            return Refusal(RefusalCode.RING_MISSING, message, math.degrees(gap_rad), math.degrees(GREATEST_GAP_RAD))
    return None


def _sectors(angles_rad: Array) -> NDArray[np.bool_]:
    """Which sectors of the full circle (72,) hold an angle."""
    occupied = np.zeros(_SECTORS, dtype=bool)
    occupied[np.floor(angles_rad / (2.0 * math.pi) * _SECTORS).astype(int) % _SECTORS] = True
    return occupied


def _longest_gap(seen: NDArray[np.bool_], missing: NDArray[np.bool_]) -> float:
    """Greatest angle of missing sectors between two seen ones, rad; sectors that are neither count nothing."""
    order = np.arange(_SECTORS) + int(np.argmax(seen))
    runs = np.add.reduceat(missing.take(order, mode="wrap").astype(int), seen.take(order, mode="wrap").nonzero()[0])
    return int(runs.max()) * 2.0 * math.pi / _SECTORS


def check_line(fit: ContourFit, observations: Observations, places: WireSamples, ends: list[LineEnd]) -> Refusal | None:
    """Accepted points along the line, of the places where it could be measured, and an end of it that is seen."""
    possible = int((places.wire == Wire.LINE).sum())
    share = float((fit.weight[observations.wire == Wire.LINE] > 0.0).sum()) / max(possible, 1)
    if share < LEAST_LINE_COVERAGE:
        return Refusal(RefusalCode.LINE_MISSING, "share of the indicator line that is seen", share, LEAST_LINE_COVERAGE)
    if len(ends) < LEAST_LINE_ENDS:
        message = "ends of the indicator line that are seen"
        return Refusal(RefusalCode.LINE_MISSING, message, len(ends), LEAST_LINE_ENDS)
    return None


def check_line_ends(ends: list[LineEnd], least_amplitude: float) -> Refusal | None:
    """The line must end where the guide file says, wherever an end can be measured."""
    faint = [end.amplitude for end in ends if not end.amplitude >= least_amplitude]
    if faint:
        message = "absorption of the indicator line at its end"
        return Refusal(RefusalCode.LINE_MISSING, message, min(faint), least_amplitude)
    worst = max(ends, key=lambda end: abs(end.excess_px) / end.sd_px, default=None)
    if worst is not None and not abs(worst.excess_px) <= GREATEST_PULL_SD * worst.sd_px:
        message = f"the indicator line's end at x = {worst.x_mm:g} mm is not where the guide file puts it (px)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, abs(worst.excess_px), GREATEST_PULL_SD * worst.sd_px)
    return None


def check_bead(distance_sd: float) -> Refusal | None:
    """The bead's centre against its prediction by the rings and the line."""
    if not distance_sd <= GREATEST_BEAD_SD:
        message = "the bead is not where the guide file puts it (standard deviations)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, distance_sd, GREATEST_BEAD_SD)
    return None


def check_predicted(predicted: PredictedError) -> Refusal | None:
    """The 95 % bounds of the targeting error, of a target where the guide is."""
    return _check_bounds(predicted, GREATEST_PREDICTED_RAD, GREATEST_PREDICTED_MM)


def check_aim(predicted: PredictedError) -> Refusal | None:
    """The same at a target's own pixel and depth: beyond what counts as wrong nobody may aim, whoever decides."""
    return _check_bounds(predicted, WRONG_RAD, WRONG_MM)


def _check_bounds(predicted: PredictedError, greatest_rad: float, greatest_mm: float) -> Refusal | None:
    for quantity, unit, measured, limit in (
        ("angle", "deg", math.degrees(predicted.angle_rad), math.degrees(greatest_rad)),
        ("position", "mm", predicted.position_mm, greatest_mm),
    ):
        if not measured <= limit:
            message = f"the predicted {quantity} error is too high ({unit}, 95 %)"
            return Refusal(RefusalCode.PREDICTED_ERROR_TOO_HIGH, message, measured, limit)
    return None

"""The gates of a registration: each measures one thing and refuses beyond its limit (H05, H06, H07)."""

import math

import numpy as np
from numpy.typing import NDArray

from vision.contour import ContourFit, Observations
from vision.line_ends import LineEnd
from vision.projection import View
from vision.refusal import Refusal, RefusalCode
from vision.registered import PredictedError
from vision.wire_model import Wire, WireSamples

Array = NDArray[np.float64]

GREATEST_RESIDUAL_PX = 0.6  # robust noise of a ridge point; a good image has 0.1, and 0.6 still aims within 0.1 deg
GREATEST_PULL_SD = 4.0  # docs/method.md: exchanged rings and wrong dimensions show in the priors alone
GREATEST_LINE_END_PX = 1.5
GREATEST_TILT_RAD = math.radians(45.0)
LEAST_RING_COVERAGE = 0.5  # of the directions about a ring's centre that hold accepted points
LEAST_LINE_COVERAGE = 0.4
LEAST_LINE_COVERAGE_WITHOUT_ENDS = 0.7  # where rings or balls cover both ends, the line itself must be seen well
GREATEST_GAP_RAD = math.radians(100.0)  # of a ring, though nothing known covers it: less than 260 deg hold it loosely
GREATEST_BEAD_SD = 4.0
GREATEST_TOGETHER = 21.7  # 99 % of chi-square, 7 priors and the bead's 2: a ring separation off strains all a little
GREATEST_SCALE_OFF = 0.06  # relative: the plate's pixel size against the C-arm file's; distances of plate and SID
GREATEST_PREDICTED_RAD = math.radians(0.25)  # half of what counts as a wrong registration, 0.5 deg and 1.0 mm
GREATEST_PREDICTED_MM = 0.5
_SECTORS = 72


def check_scale(fitted_mm: float, file_mm: float) -> Refusal | None:
    """H06: the pixel size that the plate shows against the C-arm file's."""
    off = abs(fitted_mm / file_mm - 1.0)
    if off > GREATEST_SCALE_OFF:
        message = "the pixel size by the plate contradicts the C-arm file (relative)"
        return Refusal(RefusalCode.SCALE_MISMATCH, message, off, GREATEST_SCALE_OFF)
    return None


def check_residual(fit: ContourFit) -> Refusal | None:
    """The noise of the accepted points about the model, px."""
    if fit.noise_px > GREATEST_RESIDUAL_PX:
        message = "ridge points scatter about the fitted wires (px)"
        return Refusal(RefusalCode.RESIDUAL_TOO_HIGH, message, fit.noise_px, GREATEST_RESIDUAL_PX)
    return None


def check_pulls(fit: ContourFit) -> Refusal | None:
    """No prior may be strained: guide and C-arm are those of the files."""
    name, pull = max(fit.pulls_sd.items(), key=lambda item: abs(item[1]))
    if not abs(pull) <= GREATEST_PULL_SD:
        message = f"the image contradicts the device files: {name} is off (standard deviations)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, abs(pull), GREATEST_PULL_SD)
    return None


def check_tilt(view: View) -> Refusal | None:
    """The guide's axis against the ray through the small ring's centre."""
    pose = view.source_from_guide
    cosine = float(pose[:3, 2] @ pose[:3, 3] / np.linalg.norm(pose[:3, 3]))
    tilt_rad = math.acos(max(-1.0, min(1.0, cosine)))
    if tilt_rad > GREATEST_TILT_RAD:
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
    first = int(np.argmax(seen))
    runs = np.split(np.roll(missing, -first), np.nonzero(np.roll(seen, -first))[0])
    return max(int(run.sum()) for run in runs) * 2.0 * math.pi / _SECTORS


def check_line(fit: ContourFit, observations: Observations, places: WireSamples, ends: list[LineEnd]) -> Refusal | None:
    """Accepted points along the line, of the places where it could be measured; more of them where no end is seen."""
    possible = int((places.wire == Wire.LINE).sum())
    share = float((fit.weight[observations.wire == Wire.LINE] > 0.0).sum()) / max(possible, 1)
    limit = LEAST_LINE_COVERAGE if ends else LEAST_LINE_COVERAGE_WITHOUT_ENDS
    if share < limit:
        return Refusal(RefusalCode.LINE_MISSING, "share of the indicator line that is seen", share, limit)
    return None


def check_line_ends(ends: list[LineEnd], least_amplitude: float) -> Refusal | None:
    """The line must end where the guide file says, wherever an end can be measured."""
    faint = [end.amplitude for end in ends if end.amplitude < least_amplitude]
    if faint:
        message = "absorption of the indicator line at its end"
        return Refusal(RefusalCode.LINE_MISSING, message, min(faint), least_amplitude)
    worst = max(ends, key=lambda end: abs(end.excess_px), default=None)
    if worst is not None and abs(worst.excess_px) > GREATEST_LINE_END_PX:
        message = f"the indicator line's end at x = {worst.x_mm:g} mm is not where the guide file puts it (px)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, abs(worst.excess_px), GREATEST_LINE_END_PX)
    return None


def check_bead(distance_sd: float, fit: ContourFit) -> Refusal | None:
    """The bead's centre against its prediction by the rings and the line, alone and together with the priors' pulls."""
    if not distance_sd <= GREATEST_BEAD_SD:
        message = "the bead is not where the guide file puts it (standard deviations)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, distance_sd, GREATEST_BEAD_SD)
    together = distance_sd**2 + sum(pull**2 for pull in fit.pulls_sd.values())
    if not together <= GREATEST_TOGETHER:
        message = "bead and priors together contradict the device files (chi-square of 9 degrees of freedom)"
        return Refusal(RefusalCode.GUIDE_MISMATCH, message, together, GREATEST_TOGETHER)
    return None


def check_predicted(predicted: PredictedError) -> Refusal | None:
    """The 95 % bounds of the targeting error."""
    if not predicted.angle_rad <= GREATEST_PREDICTED_RAD:
        message = "the predicted angle error is too high (deg, 95 %)"
        return Refusal(
            RefusalCode.PREDICTED_ERROR_TOO_HIGH,
            message,
            math.degrees(predicted.angle_rad),
            math.degrees(GREATEST_PREDICTED_RAD),
        )
    if not predicted.position_mm <= GREATEST_PREDICTED_MM:
        message = "the predicted position error is too high (mm, 95 %)"
        return Refusal(RefusalCode.PREDICTED_ERROR_TOO_HIGH, message, predicted.position_mm, GREATEST_PREDICTED_MM)
    return None

"""Registration from one image: plate, rings, line, fit, bead, gates. The order and the reasons: docs/method.md."""

import math
import time

import numpy as np
from numpy.typing import NDArray
from threadpoolctl import ThreadpoolController

from vision import gates, paper
from vision.bands import DETECTOR_BLUR_MM
from vision.candidates import wire_width_px
from vision.conics import Ellipse, RingPair, fiducials, fit_ellipse
from vision.corrected_image import correct
from vision.devices import CArm, Guide
from vision.findings import Findings
from vision.measuring import Scene
from vision.priors import VIEW_PARAMETERS, Priors
from vision.profiles import ProfileReader
from vision.projection import Intrinsics, View, nominal_intrinsics, project
from vision.refusal import Refusal, RefusalCode
from vision.registered import FittedDimensions, ImageIdentity, Method, Registration
from vision.search import search
from vision.solution import Solution
from vision.uncertainty import predicted_error
from vision.wire_model import Wire
from vision.xray import XrayImage

Array = NDArray[np.float64]

_LIBRARIES = ThreadpoolController()  # those of numpy and scipy, which are loaded by now


def register(
    image: XrayImage,
    guide: Guide,
    carm: CArm,
    method: Method = Method.CONTOUR,
    *,
    handedness_proved: bool = False,
) -> Registration | Refusal:
    """Intrinsics and the guide's pose from one image.

    Parameters
    ----------
    image : XrayImage
        Decoded.
    guide, carm
        The device files.
    method : Method
        Both run through the same detection and the same gates; `paper` then keeps the linear solution of 12 points.
    handedness_proved : bool
        For a guide without a bead: a nudge test has shown that this connection does not mirror (H05).

    Returns
    -------
    Registration or Refusal
        The code says which step or gate refused; never a doubtful pose.
    """
    return examine(image, guide, carm, method, handedness_proved=handedness_proved).result


def examine(
    image: XrayImage,
    guide: Guide,
    carm: CArm,
    method: Method = Method.CONTOUR,
    *,
    handedness_proved: bool = False,
) -> Findings:
    """As `register`, with what was found on the way to the registration or to the refusal."""
    # over matrices of some ten rows threads of the linear algebra only wait for one another
    with _LIBRARIES.limit(limits=1, user_api="blas"):
        return _examined(image, guide, carm, method, handedness_proved)


def _examined(image: XrayImage, guide: Guide, carm: CArm, method: Method, handedness_proved: bool) -> Findings:
    started = time.perf_counter()
    if guide.bead is None and not handedness_proved:
        message = "the guide has no bead: handedness must be proved once per C-arm connection by two images"
        return Findings(Refusal(RefusalCode.HANDEDNESS_UNPROVED, message))
    corrected = correct(image, carm)
    if isinstance(corrected, Refusal):
        return Findings(corrected)
    nominal = nominal_intrinsics(carm, image.rows, image.columns, corrected.plate.map.pixel_size_mm)
    reader = ProfileReader(corrected.absorption, corrected.plate.map, wire_width_px(guide, carm, nominal))
    priors = Priors.of(carm, guide, nominal)
    blur_px = DETECTOR_BLUR_MM / corrected.plate.map.pixel_size_mm
    scene = Scene(
        guide, priors, corrected.plate, reader, corrected.absorption.values, corrected.balls_corrected, blur_px
    )
    found = search(corrected, scene, carm)
    if isinstance(found.outcome, Refusal):
        return Findings(found.outcome, corrected, found)
    result = _registration(found.outcome, image, guide, carm, nominal, method, started)
    if isinstance(result, Registration):
        result = gates.check_predicted(result.predicted_error_95) or result
    return Findings(result, corrected, found)


def _registration(
    solution: Solution,
    image: XrayImage,
    guide: Guide,
    carm: CArm,
    nominal: Intrinsics,
    method: Method,
    started: float,
) -> Registration | Refusal:
    rings = _ellipses(solution)
    if isinstance(rings, Refusal):
        return rings
    points = fiducials(rings, *_line_ends_px(solution, guide), guide, nominal)
    if isinstance(points, Refusal):
        return points
    view, covariance = solution.fit.view, solution.fit.covariance[:VIEW_PARAMETERS, :VIEW_PARAMETERS]
    dimensions: FittedDimensions | None = _dimensions(solution)
    residual_px = math.sqrt(float(np.average(solution.fit.residual_px**2, weights=solution.fit.weight)))
    if method is Method.PAPER:
        linear = paper.solve(points, guide)
        if isinstance(linear, Refusal):
            return linear
        view, covariance, residual_px = linear.view, linear.covariance, linear.residual_rms_px
        dimensions = None
    return Registration(
        image=ImageIdentity(image.sha256, image.rows, image.columns),
        method=method,
        guide=guide,
        carm=carm,
        intrinsics=view.intrinsics,
        source_from_guide=view.source_from_guide,
        distortion=solution.fit.map,
        fiducials_px=points,
        bead_px=None if solution.bead is None else solution.bead.centre_px,
        rings=rings,
        residual_rms_px=residual_px,
        covariance=covariance,
        predicted_error_95=predicted_error(view, covariance, guide, points["small_centre"]),
        elapsed_ms=(time.perf_counter() - started) * 1000.0,
        dimensions=dimensions,
    )


def _dimensions(solution: Solution) -> FittedDimensions:
    fit = solution.fit
    values_mm = (fit.guide.small_ring_radius_mm, fit.guide.big_ring_radius_mm, fit.guide.separation_mm)
    return FittedDimensions(np.array(values_mm), fit.covariance[VIEW_PARAMETERS:])


def _ellipses(solution: Solution) -> RingPair | Refusal:
    """Ellipses through the accepted points of each ring."""
    found: list[Ellipse] = []
    for wire in (Wire.SMALL_RING, Wire.BIG_RING):
        on = (solution.observations.wire == wire) & (solution.fit.weight > 0.0)
        ellipse = fit_ellipse(solution.observations.measured[on])
        if ellipse is None:
            return Refusal(RefusalCode.RING_MISSING, "points of a ring that fit an ellipse", 0, int(on.sum()))
        found.append(ellipse)
    return RingPair(*found)


def _line_ends_px(solution: Solution, guide: Guide) -> tuple[Array, Array]:
    """Both ends of the line (2,): on the line through its points; along it as measured, else as projected."""
    on = (solution.observations.wire == Wire.LINE) & (solution.fit.weight > 0.0)
    points = solution.observations.measured[on]
    mean = points.mean(axis=0)
    along = np.linalg.svd(points - mean)[2][0]
    view: View = solution.fit.view
    ends = project(view, np.array([[guide.line_start_mm, 0.0, 0.0], [guide.line_end_mm, 0.0, 0.0]]))
    outwards = (ends[1] - ends[0]) / np.linalg.norm(ends[1] - ends[0])
    for end in solution.line_ends:
        if end.x_mm == guide.line_start_mm:
            ends[0] -= end.excess_px * outwards
        else:
            ends[1] += end.excess_px * outwards
    start, stop = (mean + ((end - mean) @ along) * along for end in ends)
    return start, stop

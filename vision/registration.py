"""Registration from one image: plate, rings, line, fit, bead, gates. The order and the reasons: docs/method.md."""

import math
import time
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from vision import gates, paper
from vision.absorption import Absorption, absorption
from vision.conics import Ellipse, RingPair, fiducials, fit_ellipse
from vision.contour import VIEW_PARAMETERS, Priors
from vision.detection import AxisRange, ring_candidates
from vision.devices import CArm, Guide
from vision.distortion import DistortionMap, PlateFit, exact, fit
from vision.first_pose import FirstView, consistent_pairs, first_view
from vision.measuring import Scene
from vision.plate import find_lattice
from vision.profiles import ProfileReader
from vision.projection import Intrinsics, View, nominal_intrinsics, project
from vision.refusal import Refusal, RefusalCode
from vision.registered import ImageIdentity, Method, Registration
from vision.solution import Solution, solve
from vision.uncertainty import predicted_error
from vision.wire_model import Wire, sample_wires
from vision.wires import ridge_points
from vision.xray import XrayImage

Array = NDArray[np.float64]

_NEAREST_SHARE, _FARTHEST_SHARE = 0.45, 0.97  # of the source-to-image distance, where a ring may be
_MOST_PAIRS = 6
_LEAST_LINE_CONTRAST = 0.4  # of the rings' own
_BALL_HALO_PX = 2.0  # around a ball's rim: blur


@dataclass(frozen=True, slots=True, eq=False)
class _Detector:
    """The image's absorption with its distortion: what every later step reads."""

    absorption: Absorption
    plate: PlateFit
    ball_radius_px: float

    @property
    def balls_raw(self) -> Array:
        """(m, 3): raw pixel and radius with its halo."""
        sites = self.plate.sites
        return np.column_stack((sites, np.full(len(sites), self.ball_radius_px + _BALL_HALO_PX)))

    @property
    def balls_corrected(self) -> Array:
        """(m, 3): corrected pixel and radius."""
        corrected = self.plate.map.corrected_from_raw(self.plate.sites)
        return np.column_stack((corrected, np.full(len(corrected), self.ball_radius_px)))


def register(image: XrayImage, guide: Guide, carm: CArm, method: Method = Method.CONTOUR) -> Registration | Refusal:
    """Intrinsics and the guide's pose from one image.

    Parameters
    ----------
    image : XrayImage
        Decoded.
    guide, carm
        The device files.
    method : Method
        Both run through the same detection and the same gates; `paper` then keeps the linear solution of 12 points.

    Returns
    -------
    Registration or Refusal
        The code says which step or gate refused; never a doubtful pose.
    """
    started = time.perf_counter()
    detector = _detector(image, carm)
    if isinstance(detector, Refusal):
        return detector
    pixel_size_mm = detector.plate.map.pixel_size_mm
    nominal = nominal_intrinsics(carm, image.rows, image.columns, pixel_size_mm)
    firsts = _first_views(detector, guide, nominal)
    if isinstance(firsts, Refusal):
        return firsts
    solution = _only_solution(firsts, _scene(detector, guide, carm, nominal))
    if isinstance(solution, Refusal):
        return solution
    registration = _registration(solution, image, guide, carm, detector.plate.map, nominal, method, started)
    if isinstance(registration, Refusal):
        return registration
    return gates.check_predicted(registration.predicted_error_95) or registration


def _detector(image: XrayImage, carm: CArm) -> _Detector | Refusal:
    seen = absorption(image)
    file_pixel_mm = carm.field_of_view_mm / max(image.rows, image.columns)
    if carm.plate is None:
        return _Detector(seen, exact(DistortionMap.identity(image.rows, image.columns, file_pixel_mm)), 0.0)
    lattice = find_lattice(seen, carm.plate, file_pixel_mm)
    if isinstance(lattice, Refusal):
        return lattice
    plate = fit(lattice.raw, lattice.places, image.rows, image.columns, carm.plate.ball_spacing_mm)
    refusal = gates.check_scale(plate.map.pixel_size_mm, file_pixel_mm)
    return refusal or _Detector(seen, plate, carm.plate.ball_diameter_mm / 2.0 / plate.map.pixel_size_mm)


def _scene(detector: _Detector, guide: Guide, carm: CArm, nominal: Intrinsics) -> Scene:
    wire_px = _wire_px(guide, carm.source_to_image_mm, nominal)
    reader = ProfileReader(detector.absorption, detector.plate.map, wire_px)
    return Scene(guide, Priors.of(carm, guide, nominal), detector.plate, reader, detector.balls_corrected)


def _wire_px(guide: Guide, source_to_image_mm: float, nominal: Intrinsics) -> float:
    """Width of a wire's shadow half-way of the plausible distances; widths differ by a third at most."""
    depth_mm = source_to_image_mm * (_NEAREST_SHARE + _FARTHEST_SHARE) / 2.0
    return guide.wire_diameter_mm * nominal.alpha_x_px / depth_mm


def _first_views(detector: _Detector, guide: Guide, nominal: Intrinsics) -> list[FirstView] | Refusal:
    """Views worth refining, the best supported first."""
    distance_mm = nominal.alpha_x_px * detector.plate.map.pixel_size_mm
    wire_px = _wire_px(guide, distance_mm, nominal)
    ridge = ridge_points(detector.absorption, detector.plate.map, wire_px, detector.balls_raw)
    per_mm = nominal.alpha_x_px / distance_mm
    axes = AxisRange(
        least_px=per_mm * guide.small_ring_radius_mm / _FARTHEST_SHARE,
        greatest_px=per_mm * guide.big_ring_radius_mm / _NEAREST_SHARE,
    )
    candidates = ring_candidates(ridge, axes)
    if not candidates:
        return Refusal(RefusalCode.NO_GUIDE_FOUND, "rings of the guide's size found", 0, 2)
    pairs = consistent_pairs(candidates, guide, nominal)[:_MOST_PAIRS]
    if not pairs:
        message = "no two of the rings found belong to one guide: consistent pairs"
        return Refusal(RefusalCode.RING_MISSING, message, 0, 1)
    found = [
        first_view(rings, support, guide, nominal, detector.absorption, detector.plate.map) for rings, support in pairs
    ]
    views = [view for view in found if view is not None]
    cut_off = [share for share in (_share_inside(view, guide, detector) for view in views) if share < 1.0]
    if len(cut_off) == len(views):
        return Refusal(RefusalCode.GUIDE_CUT_OFF, "share of the guide inside the field", max(cut_off), 1.0)
    return views


def _share_inside(first: FirstView, guide: Guide, detector: _Detector) -> float:
    """Share of the wires inside the field."""
    raw = np.rint(detector.plate.map.raw_from_corrected(sample_wires(first.view, guide).points)).astype(np.intp)
    rows, columns = detector.absorption.inside.shape
    seen = ((raw >= 0) & (raw < (columns, rows))).all(axis=1)
    return float((seen & detector.absorption.inside[np.where(seen, raw[:, 1], 0), np.where(seen, raw[:, 0], 0)]).mean())


def _only_solution(firsts: list[FirstView], scene: Scene) -> Solution | Refusal:
    """The one view that passes; the best supported view's refusal where none does, `ambiguous` where two do."""
    refusals: list[Refusal] = []
    solutions: list[Solution] = []
    for first in firsts:
        if first.line_contrast < _LEAST_LINE_CONTRAST:
            message = "contrast of the indicator line against the rings'"
            refusals.append(Refusal(RefusalCode.LINE_MISSING, message, first.line_contrast, _LEAST_LINE_CONTRAST))
            continue
        result = solve(first, scene)
        if isinstance(result, Refusal):
            refusals.append(result)
        elif not any(_same_place(result, other) for other in solutions):
            solutions.append(result)
    if len(solutions) > 1:
        return Refusal(RefusalCode.AMBIGUOUS, "guides seen in the image", len(solutions), 1)
    return solutions[0] if solutions else refusals[0]


def _same_place(one: Solution, other: Solution) -> bool:
    apart = one.fit.view.source_from_guide[:3, 3] - other.fit.view.source_from_guide[:3, 3]
    return float(np.linalg.norm(apart)) < 1.0  # mm: refits of one guide agree far better, two guides cannot be so near


def _registration(
    solution: Solution,
    image: XrayImage,
    guide: Guide,
    carm: CArm,
    distortion: DistortionMap,
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
    residual_px = math.sqrt(float(np.average(solution.fit.residual_px**2, weights=solution.fit.weight)))
    if method is Method.PAPER:
        linear = paper.solve(points, guide)
        if isinstance(linear, Refusal):
            return linear
        view, covariance, residual_px = linear.view, linear.covariance, linear.residual_rms_px
    return Registration(
        image=ImageIdentity(image.sha256, image.rows, image.columns),
        method=method,
        guide=guide,
        carm=carm,
        intrinsics=view.intrinsics,
        source_from_guide=view.source_from_guide,
        distortion=distortion,
        fiducials_px=points,
        bead_px=None if solution.bead is None else solution.bead.centre_px,
        rings=rings,
        residual_rms_px=residual_px,
        covariance=covariance,
        predicted_error_95=predicted_error(view, covariance, guide, points["small_centre"]),
        elapsed_ms=(time.perf_counter() - started) * 1000.0,
    )


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

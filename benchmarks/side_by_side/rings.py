"""Ring finders on the same straightened images: which rings they find, how well, and what they find besides."""

import time
import warnings
from collections.abc import Callable, Iterable
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from skimage.measure import EllipseModel, ransac

from benchmarks.side_by_side.pictures import GUIDE, Picture
from vision.candidates import wire_width_px
from vision.conics import Ellipse, fit_ellipse
from vision.corrected_image import CorrectedImage
from vision.curvature import Curvature
from vision.detection import QUICK, AxisRange, ring_candidates
from vision.projection import nominal_intrinsics
from vision.refusal import Refusal
from vision.wires import Ridge, ridge_points, wire_curvature_sigma_px

Array = NDArray[np.float64]
Found = list[tuple[float, float, float, float]]  # centre u, v, semi-axes, px

_MATCH_PX = 6.0  # in centre and axes; finders of edges see both flanks of a wire, 3 px off its middle
_AXES_PX = (54.0, 200.0)  # of the guide's rings wherever a guide may be: all finders are told
_BACKGROUND_PX = 15  # what is wider is no wire
_RANSAC_TRIALS = 1500
_RANSAC_POINTS = 300  # drawn of the ridge points: the model measures distances by an optimisation for every point
_RANSAC_WITHIN_PX = 1.5


@dataclass(frozen=True, slots=True)
class RingScore:
    """One finder on one image: centre errors of the rings found (of two), other ellipses, processor time."""

    finder: str
    picture: str
    centre_errors_px: tuple[float, ...]
    false: int
    cpu_ms: float


@dataclass(frozen=True, slots=True, eq=False)
class Straightened:
    """What a finder may use: the flattened 8-bit image in corrected pixels, or the ridge points and the image."""

    flattened: NDArray[np.uint8]
    picture: Picture
    corrected: CorrectedImage


def ring_scores(picture: Picture) -> Iterable[RingScore]:
    """Every finder on an image whose distortion is known."""
    corrected = picture.findings.corrected
    if corrected is None:
        return
    straightened = Straightened(_flattened(corrected), picture, corrected)
    true = [_true_ring(picture, corrected, *ring) for ring in _guide_rings()]
    for finder, find in FINDERS.items():
        started_s = time.process_time()
        found = [one for one in find(straightened) if _AXES_PX[0] <= one[3] <= one[2] <= _AXES_PX[1]]
        cpu_ms = picture.cpu_ms if finder == REGISTERED else (time.process_time() - started_s) * 1000.0
        yield _judged(finder, picture, found, true, cpu_ms)


def _judged(finder: str, picture: Picture, found: Found, true: list[Ellipse], cpu_ms: float) -> RingScore:
    """Match by place and size; several ellipses on one ring count as one, the best of them, for every finder."""
    round_only = finder == HOUGH
    errors, matched = [], set()
    for ring in true:
        on = [index for index, one in enumerate(found) if _matches(one, ring, round_only)]
        matched |= set(on)
        if on:
            errors.append(float(min(np.hypot(*np.subtract(found[index][:2], ring.centre_px)) for index in on)))
    return RingScore(finder, picture.sample.name, tuple(errors), len(found) - len(matched), cpu_ms)


def _matches(one: tuple[float, float, float, float], ring: Ellipse, round_only: bool) -> bool:
    near = np.hypot(*np.subtract(one[:2], ring.centre_px)) < _MATCH_PX
    if round_only:
        return bool(near and ring.semi_axes_px[1] - _MATCH_PX < one[2] < ring.semi_axes_px[0] + _MATCH_PX)
    return bool(near and np.all(np.abs(np.subtract(one[2:], ring.semi_axes_px)) < _MATCH_PX))


def _guide_rings() -> tuple[tuple[float, float], ...]:
    return (GUIDE.small_ring_radius_mm, 0.0), (GUIDE.big_ring_radius_mm, -GUIDE.separation_mm)


def _true_ring(picture: Picture, corrected: CorrectedImage, radius_mm: float, z_mm: float) -> Ellipse:
    """The ellipse on which a ring of the scene lies in corrected pixels."""
    turn = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
    ring = np.stack([radius_mm * np.cos(turn), radius_mm * np.sin(turn), np.full_like(turn, z_mm)], axis=-1)
    pose = picture.scene.guides[0].source_from_guide
    ideal = picture.scene.camera.project(ring @ pose[:3, :3].T + pose[:3, 3])
    raw = picture.scene.distortion.raw_from_ideal(ideal)
    ellipse = fit_ellipse(corrected.plate.map.corrected_from_raw(raw))
    if ellipse is None:
        raise ValueError("a ring of the scene is no ellipse")
    return ellipse


def _flattened(corrected: CorrectedImage) -> NDArray[np.uint8]:
    """Wires bright on black, 8 bits: absorption in corrected pixels above its morphological opening."""
    rows, columns = corrected.absorption.values.shape
    grid = np.stack(np.meshgrid(np.arange(columns), np.arange(rows)), axis=-1).reshape(-1, 2).astype(np.float64)
    raw = corrected.plate.map.raw_from_corrected(grid).reshape(rows, columns, 2).astype(np.float32)
    inside = cv2.remap(corrected.absorption.inside.astype(np.uint8), raw[..., 0], raw[..., 1], cv2.INTER_NEAREST)
    straight = cv2.remap(corrected.absorption.values, raw[..., 0], raw[..., 1], cv2.INTER_LINEAR)
    straight = cv2.GaussianBlur(straight, (0, 0), 1.0)
    kernel = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (_BACKGROUND_PX, _BACKGROUND_PX))
    wires = cv2.morphologyEx(straight, cv2.MORPH_TOPHAT, kernel)
    wires[cv2.erode(inside, kernel) == 0] = 0.0
    scale = 255.0 / max(float(np.percentile(wires[inside > 0], 99.0)), 1e-6)
    return np.clip(wires * scale, 0.0, 255.0).astype(np.uint8)


def _hough(image: Straightened) -> Found:
    circles = cv2.HoughCircles(
        image.flattened,
        cv2.HOUGH_GRADIENT_ALT,
        dp=1.5,
        minDist=10.0,
        param1=300.0,
        param2=0.6,
        minRadius=int(_AXES_PX[0]),
        maxRadius=int(_AXES_PX[1]),
    )
    return [] if circles is None else [(u, v, radius, radius) for u, v, radius in circles.reshape(-1, 3)]


def _edge_drawing(image: Straightened) -> Found:
    drawing = cv2.ximgproc.createEdgeDrawing()
    drawing.detectEdges(image.flattened)
    ellipses = drawing.detectEllipses()
    if ellipses is None:
        return []
    return [
        (u, v, *sorted((radius + a, radius + b), reverse=True)) for u, v, radius, a, b, _ in ellipses.reshape(-1, 6)
    ]


def _arcs(image: Straightened) -> Found:
    ellipses = cv2.ximgproc.findEllipses(image.flattened, scoreThreshold=0.5, reliabilityThreshold=0.3)
    if ellipses is None:
        return []
    return [(one[0], one[1], *sorted(one[2:4], reverse=True)) for one in ellipses.reshape(-1, ellipses.shape[-1])]


def _ridge(image: Straightened) -> Ridge:
    corrected, carm = image.corrected, image.picture.sample.carm
    rows, columns = corrected.absorption.values.shape
    nominal = nominal_intrinsics(carm, rows, columns, corrected.plate.map.pixel_size_mm)
    sigma_px = wire_curvature_sigma_px(wire_width_px(GUIDE, carm, nominal))
    return ridge_points(Curvature.of(corrected.absorption, sigma_px), corrected.plate.map, corrected.balls_raw)


def _ransac(image: Straightened) -> Found:
    """Two ellipses, one after the other, through this project's ridge points."""
    points, found = _ridge(image).points, []
    points = np.random.default_rng(image.picture.seed).permutation(points)[:_RANSAC_POINTS]
    for _ in range(2):
        if len(points) < 20:
            break
        model, inliers = _consensus(points, image.picture.seed)
        if model is None or inliers is None:
            break
        (u, v), axes = model.center, sorted(model.axis_lengths, reverse=True)
        found.append((float(u), float(v), float(axes[0]), float(axes[1])))
        points = points[~inliers]
    return found


def _consensus(points: Array, seed: int) -> tuple[EllipseModel | None, NDArray[np.bool_] | None]:
    with warnings.catch_warnings(action="ignore", category=UserWarning):  # that there is none: counted as missed
        model, inliers = ransac(
            points,
            EllipseModel,
            min_samples=5,
            residual_threshold=_RANSAC_WITHIN_PX,
            max_trials=_RANSAC_TRIALS,
            is_model_valid=_is_plausible,
            rng=seed,
        )
    return model, inliers


def _is_plausible(model: EllipseModel, *_points: Array) -> bool:
    least, greatest = sorted(model.axis_lengths)
    return bool(least > 0.5 * greatest and _AXES_PX[0] <= least and greatest <= _AXES_PX[1])


def _own(image: Straightened) -> Found:
    """The first, quick search; the model of the guide is not used yet."""
    candidates = ring_candidates(_ridge(image), AxisRange(*_AXES_PX), QUICK)
    return [(*one.ellipse.centre_px, *one.ellipse.semi_axes_px) for one in candidates]


def _registered(image: Straightened) -> Found:
    result = image.picture.findings.result
    if isinstance(result, Refusal):
        return []
    return [(*ring.centre_px, *ring.semi_axes_px) for ring in (result.rings.small, result.rings.big)]


HOUGH = "cv2.HoughCircles"
REGISTERED = "this project, after registration"
FINDERS: dict[str, Callable[[Straightened], Found]] = {
    "this project, ridges and votes": _own,
    REGISTERED: _registered,
    HOUGH: _hough,
    "ximgproc.EdgeDrawing": _edge_drawing,
    "ximgproc.findEllipses": _arcs,
    "skimage EllipseModel, RANSAC": _ransac,
}

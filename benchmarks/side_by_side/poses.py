"""Pose and intrinsics from the same 12 fiducials by several methods, judged by the move that follows from them."""

import time
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray

from benchmarks.samples import errors
from benchmarks.side_by_side.pictures import GUIDE, Picture
from vision import paper
from vision.alignment import goal
from vision.projection import Intrinsics, View, fiducials_in_guide, nominal_intrinsics
from vision.refusal import Refusal
from vision.registered import Registration

Array = NDArray[np.float64]
Solver = Callable[[Mapping[str, Array], Intrinsics], View | None]

CONTOUR = "this project, all contour points"  # its time is that of a whole registration, from the image
_POINTS = np.array(list(fiducials_in_guide(GUIDE).values()))
_FREE = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_ASPECT_RATIO | cv2.CALIB_ZERO_TANGENT_DIST
_NO_LENS = cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3  # the plate's correction has straightened the image


@dataclass(frozen=True, slots=True)
class PoseScore:
    """One method on one image: errors of the move, and processor time, the solver's own but for the contour's."""

    method: str
    picture: str
    angle_deg: float | None
    position_mm: float | None
    cpu_ms: float


def pose_scores(picture: Picture) -> Iterable[PoseScore]:
    """Every method on an image that was registered; all get its corrected pixels and fiducials."""
    registration = picture.findings.result
    if isinstance(registration, Refusal):
        return
    pixel = registration.distortion.corrected_from_raw(np.array([picture.sample.truth["target_raw_px"]]))[0]
    yield _score(CONTOUR, picture, registration.view(), pixel, picture.cpu_ms)
    image, plate = picture.image, registration.distortion
    nominal = nominal_intrinsics(picture.sample.carm, image.rows, image.columns, plate.pixel_size_mm)
    for method, (solve, points) in _methods(registration).items():
        started_s = time.process_time()
        view = solve(points, nominal)
        yield _score(method, picture, view, pixel, (time.process_time() - started_s) * 1000.0)


def _methods(registration: Registration) -> dict[str, tuple[Solver, Mapping[str, Array]]]:
    true = registration.fiducials_px
    rings = registration.rings
    plain = {
        **true,
        "small_centre": np.array(rings.small.centre_px),
        "big_centre": np.array(rings.big.centre_px),
    }
    return {
        "paper, linear, ellipses' centres": (_linear, plain),
        "paper, linear, true centres": (_linear, true),
        "cv2.calibrateCamera": (_calibrated, true),
        "cv2.solvePnP, K of the C-arm file": (_posed, true),
    }


def _linear(points: Mapping[str, Array], _nominal: Intrinsics) -> View | None:
    solution = paper.solve(points, GUIDE)
    return None if isinstance(solution, Refusal) else solution.view


def _calibrated(points: Mapping[str, Array], nominal: Intrinsics) -> View | None:
    """Distance, principal point and pose by OpenCV, from one view; it starts at the C-arm file's K."""
    pixels = _pixels(points)
    size = (round(2.0 * nominal.u0_px + 1.0), round(2.0 * nominal.v0_px + 1.0))
    try:
        _, matrix, _, turns, shifts = cv2.calibrateCamera(
            [_POINTS.astype(np.float32)],
            [pixels.astype(np.float32)],
            size,
            nominal.matrix(),
            np.zeros(5),
            flags=_FREE | _NO_LENS,
        )
    except cv2.error:
        return None
    return _view(matrix, turns[0], shifts[0])


def _posed(points: Mapping[str, Array], nominal: Intrinsics) -> View | None:
    """The pose alone, with the K that the C-arm file predicts."""
    solved, turn, shift = cv2.solvePnP(_POINTS, _pixels(points), nominal.matrix(), None, flags=cv2.SOLVEPNP_SQPNP)
    if not solved:
        return None
    turn, shift = cv2.solvePnPRefineLM(_POINTS, _pixels(points), nominal.matrix(), np.zeros(5), turn, shift)
    return _view(nominal.matrix(), turn, shift)


def _pixels(points: Mapping[str, Array]) -> Array:
    return np.array([points[name] for name in fiducials_in_guide(GUIDE)])


def _view(matrix: Array, turn: Array, shift: Array) -> View:
    pose = np.eye(4)
    pose[:3, :3] = cv2.Rodrigues(turn)[0]
    pose[:3, 3] = shift.ravel()
    return View(Intrinsics(matrix[0, 0], matrix[1, 1], matrix[0, 2], matrix[1, 2]), pose)


def _score(method: str, picture: Picture, view: View | None, pixel: Array, cpu_ms: float) -> PoseScore:
    if view is None:
        return PoseScore(method, picture.sample.name, None, None, cpu_ms)
    angle_deg, position_mm = errors(picture.sample, goal(view, pixel)[0])
    return PoseScore(method, picture.sample.name, angle_deg, position_mm, cpu_ms)

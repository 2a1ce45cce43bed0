"""Calibrated triangulation from two views, each calibrated by a phantom that is seen in it.

The phantom stands beside the target; the arm is registered to it by touching six places of it with its own tip. Entry
and target are picked in both views. The image is modelled by its geometry and the noise of beads and picks.
"""

from dataclasses import dataclass

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmarks.side_by_side.theatre import GuideErrors, Theatre
from simulator.by_eye import GUIDE_FROM_SOURCE_MM
from simulator.carm.geometry import SOURCE_TO_ISOCENTRE_MM, Angles
from simulator.frames import ROOM_FROM_BASE, inverse

Array = NDArray[np.float64]

_BEADS = 20
_PHANTOM_HALF_MM = np.array([45.0, 25.0, 45.0])
_PHANTOM_FROM_TARGET_MM = np.array([0.0, 0.0, 95.0])  # above the back, room frame: nothing of it lies in the patient
_BEAD_SD_MM = 0.02  # of its making
_BEAD_SD_PX = 0.05  # of finding it
_TOUCHED = 6
_TOUCH_SD_MM = 0.1  # of the tip in a divot, per axis
_BETWEEN_VIEWS_RAD = np.deg2rad(45.0)
_GUIDE_ABOVE_TARGET_MM = GUIDE_FROM_SOURCE_MM - SOURCE_TO_ISOCENTRE_MM
_FREE = cv2.CALIB_USE_INTRINSIC_GUESS | cv2.CALIB_FIX_ASPECT_RATIO | cv2.CALIB_ZERO_TANGENT_DIST
_NO_LENS = cv2.CALIB_FIX_K1 | cv2.CALIB_FIX_K2 | cv2.CALIB_FIX_K3


@dataclass(frozen=True, slots=True, eq=False)
class _Phantom:
    """Beads and divots (n, 3) as its file has them, and where it truly stands (4x4, room frame)."""

    beads: Array
    true_beads: Array
    room_from_phantom: Array


@dataclass(frozen=True, slots=True, eq=False)
class _CalibratedView:
    """The projection (3, 4) of a view from phantom coordinates, and what was picked in it (2, 2): entry, target."""

    projection: Array
    picked: Array


def place_biplanar(theatre: Theatre) -> GuideErrors:
    """Two exposures, one motion."""
    phantom = _placed(theatre)
    views = [_view(theatre, phantom, angles) for angles in _both(theatre.angles)]
    entry, target = (_triangulated([(view.projection, view.picked[index]) for view in views]) for index in range(2))
    base_from_phantom = _touched(theatre, phantom)
    path = base_from_phantom[:3, :3] @ ((entry - target) / np.linalg.norm(entry - target))
    base_from_goal = _along(path, theatre.base_from_guide)
    base_from_goal[:3, 3] = (base_from_phantom @ np.append(target, 1.0))[:3] + _GUIDE_ABOVE_TARGET_MM * path
    theatre.move(base_from_goal)
    return theatre.errors()


def _placed(theatre: Theatre) -> _Phantom:
    beads = theatre.rng.uniform(-1.0, 1.0, (_BEADS, 3)) * _PHANTOM_HALF_MM
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(0.1 * theatre.rng.standard_normal(3)).as_matrix()
    pose[:3, 3] = theatre.in_room(theatre.pedicle.target_in_patient) + _PHANTOM_FROM_TARGET_MM
    return _Phantom(beads, beads + _BEAD_SD_MM * theatre.rng.standard_normal(beads.shape), pose)


def _both(first: Angles) -> tuple[Angles, Angles]:
    """The path's own view, and one turned about the patient's long axis, to the side where the C-arm can go."""
    orbital = first.from_vertical_rad[0]
    turn = -_BETWEEN_VIEWS_RAD if orbital > 0.0 else _BETWEEN_VIEWS_RAD
    return first, Angles(first.primary_rad + turn, first.secondary_rad)


def _view(theatre: Theatre, phantom: _Phantom, angles: Angles) -> _CalibratedView:
    stand = theatre.stand(angles)
    scene = theatre.expose(stand)
    source_from_phantom = inverse(stand.room_from_source()) @ phantom.room_from_phantom
    beads = phantom.true_beads @ source_from_phantom[:3, :3].T + source_from_phantom[:3, 3]
    seen = scene.camera.project(beads)
    seen = seen + _BEAD_SD_PX * theatre.rng.standard_normal(seen.shape)
    alpha_px = theatre.nominal.source_to_image_mm / scene.camera.pixel_mm
    guess = np.array([[alpha_px, 0.0, 511.5], [0.0, alpha_px, 511.5], [0.0, 0.0, 1.0]])
    _, matrix, _, turns, shifts = cv2.calibrateCamera(
        [phantom.beads.astype(np.float32)],
        [seen.astype(np.float32)],
        (1024, 1024),
        guess,
        np.zeros(5),
        flags=_FREE | _NO_LENS,
    )
    projection = matrix @ np.hstack([cv2.Rodrigues(turns[0])[0], shifts[0]])
    points = (theatre.pedicle.entry_in_patient, theatre.pedicle.target_in_patient)
    return _CalibratedView(projection, np.array([theatre.picked(scene, point) for point in points]))


def _triangulated(seen: list[tuple[Array, Array]]) -> Array:
    """The point (3,) in phantom coordinates of its pixels in two views."""
    (first, at_first), (second, at_second) = seen
    point = cv2.triangulatePoints(first, second, at_first, at_second)[:, 0]
    triangulated: Array = point[:3] / point[3]
    return triangulated


def _touched(theatre: Theatre, phantom: _Phantom) -> Array:
    """`base_from_phantom` (4x4) from six beads' divots touched with the tip, by least squares."""
    moves = theatre.moves
    pose = inverse(ROOM_FROM_BASE) @ phantom.room_from_phantom
    true = phantom.true_beads[:_TOUCHED] @ pose[:3, :3].T + pose[:3, 3]
    true = true + _TOUCH_SD_MM * theatre.rng.standard_normal(true.shape)
    told = np.array([theatre.touch(point) for point in true])
    theatre.moves = moves  # their time is the phantom's
    beads = phantom.beads[:_TOUCHED]
    turn, _ = Rotation.align_vectors(told - told.mean(axis=0), beads - beads.mean(axis=0))
    registered = np.eye(4)
    registered[:3, :3] = turn.as_matrix()
    registered[:3, 3] = told.mean(axis=0) - turn.apply(beads.mean(axis=0))
    return registered


def _along(axis: Array, base_from_guide: Array) -> Array:
    """A pose whose z is an axis, turned from the present one as little as possible."""
    x = base_from_guide[:3, 0] - axis * (axis @ base_from_guide[:3, 0])
    x = x / np.linalg.norm(x)
    pose = np.eye(4)
    pose[:3, :3] = np.column_stack([x, np.cross(axis, x), axis])
    return pose

"""The Cramer-Rao bound of the targeting error: the Fisher information of a rendered image's pixels.

Free are the pose, the source-to-image distance, the principal point, the plate's place and the distortion, a polynomial
as the product fits it; the guide's dimensions and the background are known. Quantum noise is taken for white with its
density at low frequencies, which the wires' edges live on; a step of the display adds its twelfth part squared.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace

import cv2
import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.carm.anatomy import enlarge
from simulator.carm.camera import pixel_grid
from simulator.carm.quick_render import shade_metal, soft_depths
from simulator.carm.scene import PlacedGuide, Scene
from vision.alignment import angle_vector, goal, position_vector, ray_in_source, target_in_source
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.projection import Intrinsics, View
from vision.registered import DEFAULT_DEPTH_MM

Array = NDArray[np.float64]

_DEGREE = 6  # of the distortion's polynomial; the product chooses 5 to 7
_CAMERA = 9  # rotation vector (rad), translation (mm), source-to-image distance (mm), principal point (px)
_PLATE = 3  # shift (px) and turn (rad)
_STEPS = np.array([2e-4] * 3 + [0.05, 0.05, 0.5] + [1.0])  # some tenths of a pixel each, for derivatives
_SHIFT_PX = 0.2  # the same, of the image
_PRIOR_SD = np.array([30.0, 15.0, 15.0])  # mm, px: of the C-arm file
_FREE_SD_PX = 30.0  # of what nothing is known of: only keeps shift and turn, which two share, solvable
_LEAST_SIGNAL = 1e-7  # of the white intensity


@dataclass(frozen=True)
class Bound:
    """Root mean squares of angle and position error that no unbiased estimator undercuts."""

    angle_deg: float
    position_mm: float


def pixel_bound(scene: Scene, guide: Guide) -> Bound:
    """Of one scene, for its target at the default depth."""
    changes, noise = _changes(scene)
    information = (changes / noise[:, None]).T @ changes + np.diag(1.0 / _prior_sd(changes.shape[1]) ** 2)
    scale = 1.0 / np.sqrt(np.diag(information))
    covariance = np.linalg.inv(information * np.outer(scale, scale)) * np.outer(scale, scale)
    by_parameter = _error_jacobian(scene, guide, changes.shape[1])
    spread = by_parameter @ covariance @ by_parameter.T
    angle_rad, position_mm = np.sqrt(np.trace(spread[:3, :3])), np.sqrt(np.trace(spread[3:, 3:]))
    return Bound(float(np.degrees(angle_rad)), float(position_mm))


def _prior_sd(count: int) -> Array:
    sd = np.full(count, _FREE_SD_PX)
    sd[:3], sd[3:6] = 1.0, 100.0
    sd[6:_CAMERA] = _PRIOR_SD
    return sd


def _changes(scene: Scene) -> tuple[Array, Array]:
    """Derivative (n, k) of the pixels' intensity by the parameters, and the noise's variance (n,), where any change."""
    soft = np.exp(-enlarge(soft_depths(scene), scene.camera.columns, scene.camera.rows)).astype(np.float64)
    metal, balls = _metal(scene), _ball_light(scene)
    clean = _blurred(soft * metal * balls, scene)
    white = float(np.percentile(clean[::4, ::4], 99.0))
    by_metal = [soft * balls * change for change in (*_slopes(scene, _metal), *_by_pose(scene))]
    by_balls = [soft * metal * change for change in _slopes(scene, _ball_light)] if scene.plate else []
    images = [_blurred(image, scene) / white for image in (*by_metal, *by_balls)]
    v, u = np.nonzero(np.max(np.abs(images), axis=0) > _LEAST_SIGNAL)
    seen = np.array([image[v, u] for image in images]).T
    metal_u, metal_v, pose = seen[:, 0], seen[:, 1], seen[:, 2:9]
    columns = [pose, -metal_u[:, None], -metal_v[:, None]]
    if scene.plate is not None:
        columns += _plate_columns(scene, u, v, seen[:, 9], seen[:, 10])
        basis = _distortion(scene).basis(np.column_stack((u, v)).astype(np.float64))
        columns += [(metal_u + seen[:, 9])[:, None] * basis, (metal_v + seen[:, 10])[:, None] * basis]
    return np.hstack(columns), _variance(clean[v, u] / white, scene)


def _plate_columns(scene: Scene, u: NDArray[np.intp], v: NDArray[np.intp], by_u: Array, by_v: Array) -> list[Array]:
    ideal = scene.distortion.ideal_from_raw(np.column_stack((u, v)).astype(np.float64))
    x, y = (ideal - scene.distortion.centre_px).T
    return [-by_u[:, None], -by_v[:, None], (by_u * y - by_v * x)[:, None] / scene.distortion.centre_px]


def _variance(signal: Array, scene: Scene) -> Array:
    """Of the intensity, in shares of the white: quanta, and the display's steps brought back through its gamma."""
    exposure = scene.exposure
    steepness = 0.91 * exposure.gain * exposure.gamma * np.maximum(signal, 1e-4) ** (exposure.gamma - 1.0)
    step = 1.0 / (2.0**exposure.bits - 1.0)
    return np.asarray(signal / exposure.photons + step**2 / 12.0 / steepness**2)


def _blurred(image: Array, scene: Scene) -> Array:
    return np.asarray(cv2.GaussianBlur(image, (0, 0), scene.exposure.blur_px), dtype=np.float64)


def _metal(scene: Scene) -> Array:
    """What the wires and the bead let through (rows, columns)."""
    light = np.ones((scene.camera.rows, scene.camera.columns), dtype=np.float32)
    for guide in scene.guides:
        shade_metal(light, scene, guide)
    return light.astype(np.float64)


def _ball_light(scene: Scene) -> Array:
    """What the plate's balls let through (rows, columns)."""
    if scene.plate is None:
        return np.ones((scene.camera.rows, scene.camera.columns))
    depths = scene.plate.depths(scene.camera, scene.distortion.ideal_from_raw(pixel_grid(scene.camera)))
    softened = cv2.GaussianBlur(np.exp(-depths), (0, 0), 0.3)  # the mean over a pixel
    return np.asarray(softened, dtype=np.float64)


def _slopes(scene: Scene, light: Callable[[Scene], Array]) -> list[Array]:
    """Derivatives of an image by a shift of the ideal pixel along u and v."""
    found = []
    for step in np.eye(2) * _SHIFT_PX:
        images = [light(_shifted(scene, sign * step)) for sign in (1.0, -1.0)]
        found.append((images[0] - images[1]) / (2.0 * _SHIFT_PX))
    return found


def _shifted(scene: Scene, step: Array) -> Scene:
    u, v = scene.distortion.shift_px
    return replace(scene, distortion=replace(scene.distortion, shift_px=(u + float(step[0]), v + float(step[1]))))


def _by_pose(scene: Scene) -> list[Array]:
    """Derivatives of the wires' light by rotation vector (rad), translation (mm), source-to-image distance (mm)."""
    found = []
    for index, size in enumerate(_STEPS):
        step = np.zeros(_CAMERA)
        images = []
        for sign in (1.0, -1.0):
            step[index] = sign * size
            images.append(_metal(_moved(scene, step)))
        found.append((images[0] - images[1]) / (2.0 * size))
    return found


def _moved(scene: Scene, step: Array) -> Scene:
    placed = scene.guides[0]
    pose = placed.source_from_guide.copy()
    pose[:3, :3] = Rotation.from_rotvec(step[:3]).as_matrix() @ pose[:3, :3]
    pose[:3, 3] += step[3:6]
    camera = replace(scene.camera, source_to_image_mm=scene.camera.source_to_image_mm + float(step[6]))
    return replace(scene, guides=(PlacedGuide(placed.shape, pose),), camera=camera)


def _distortion(scene: Scene) -> DistortionMap:
    terms = (_DEGREE + 1) * (_DEGREE + 2) // 2
    centre, half = scene.distortion.centre_px, scene.camera.columns / 2.0
    return DistortionMap((centre, centre), half, _DEGREE, np.zeros((terms, 2)), 0, 0.0, scene.camera.pixel_mm)


def _error_jacobian(scene: Scene, guide: Guide, count: int) -> Array:
    """Derivative (6, k) of the error vectors, angle (rad) and position (mm), by an error in each parameter."""
    raw = scene.distortion.raw_from_ideal(np.array(scene.target_ideal_px))[None]
    basis = _distortion(scene).basis(raw)[0] if scene.plate is not None else np.zeros(0)
    columns = []
    for index in range(count):
        size = 1e-5 if index < 3 else 1e-3
        step = np.zeros(count)
        ends = []
        for sign in (1.0, -1.0):
            step[index] = sign * size
            ends.append(_error_vectors(scene, guide, step, basis))
        columns.append((ends[0] - ends[1]) / (2.0 * size))
    return np.column_stack(columns)


def _error_vectors(scene: Scene, guide: Guide, step: Array, basis: Array) -> Array:
    """What a registration that is off by `step` commands, against the truth."""
    bent, terms = np.zeros(2), len(basis)
    if terms:
        coefficients = step[_CAMERA + _PLATE :]
        bent = np.array([basis @ coefficients[:terms], basis @ coefficients[terms:]])
    pixel = np.array(scene.target_ideal_px)
    guide_from_goal, _ = goal(_view(_moved(scene, step), step[7:_CAMERA]), pixel + bent)
    return error_vectors(scene, guide, guide_from_goal)


def error_vectors(scene: Scene, guide: Guide, guide_from_goal: Array) -> Array:
    """Angle (rad) and position (mm) vectors (6,) of a commanded motion (4, 4), source frame."""
    truth, pixel = _view(scene, np.zeros(2)), np.array(scene.target_ideal_px)
    axis = truth.source_from_guide @ guide_from_goal
    target = target_in_source(truth, pixel, guide, DEFAULT_DEPTH_MM)
    angle = angle_vector(axis[:3, 2], ray_in_source(truth.intrinsics, pixel))
    return np.concatenate((angle, position_vector(axis[:3, 3], axis[:3, 2], target)))


def _view(scene: Scene, centre_step_px: Array) -> View:
    camera = scene.camera
    alpha_px = camera.source_to_image_mm / camera.pixel_mm
    u0, v0 = np.array([camera.principal_u_px, camera.principal_v_px]) + centre_step_px
    return View(Intrinsics(alpha_px, alpha_px, float(u0), float(v0)), scene.guides[0].source_from_guide)

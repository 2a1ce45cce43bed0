"""The Cramer-Rao bound of the targeting error: the Fisher information of a rendered image's pixels.

Free are the pose, the source-to-image distance, the principal point, the plate's place, the distortion, a polynomial as
the product fits it, and the guide's radii and separation within the tolerances of its file; the background is known.
Quantum noise is taken for white with its density at low frequencies, which the wires' edges live on; a step of the
display adds its twelfth part squared.
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
_MOVES = 10  # rotation vector (rad), translation (mm), source-to-image distance, radii and separation (mm)
_CAMERA = _MOVES + 2  # and the principal point (px)
_PLATE = 3  # shift (px) and turn (rad)
_STEPS = np.array([2e-4] * 3 + [0.05, 0.05, 0.5] + [1.0] + [0.05] * 3)  # some tenths of a pixel each, for derivatives
_SHIFT_PX = 0.2  # the same, of the image
_DISTANCE_SD_MM, _CENTRE_SD_PX = 30.0, 15.0  # of the C-arm file
_FREE_SD_PX = 30.0  # of what nothing is known of: only keeps shift and turn, which two share, solvable
_LEAST_SIGNAL = 1e-7  # of the white intensity
_CHUNK = 4096  # pixels at a time, for the memory's sake


@dataclass(frozen=True)
class Bound:
    """Root mean squares of angle and position error that no unbiased estimator undercuts."""

    angle_deg: float
    position_mm: float


@dataclass(frozen=True)
class Changes:
    """How a scene's image changes.

    Attributes
    ----------
    fields : Array
        (k, rows, columns), derivatives of the intensity, in shares of the white: by a shift of the wires along u and v,
        by the ten parameters that move them, and with a plate by a shift of its balls along u and v.
    clean : Array
        (rows, columns): the intensity itself.
    background : Array
        (rows, columns): the same without wires, bead and balls.
    """

    fields: Array
    clean: Array
    background: Array

    @classmethod
    def of(cls, scene: Scene) -> "Changes":
        """Rendered without noise."""
        soft = np.exp(-enlarge(soft_depths(scene), scene.camera.columns, scene.camera.rows)).astype(np.float64)
        metal, balls = _metal(scene), _ball_light(scene)
        clean = _blurred(soft * metal * balls, scene)
        white = float(np.percentile(clean[::4, ::4], 99.0))
        by_metal = [soft * balls * change for change in (*_slopes(scene, _metal), *_by_pose(scene))]
        by_balls = [soft * metal * change for change in _slopes(scene, _ball_light)] if scene.plate else []
        fields = np.array([_blurred(image, scene) / white for image in (*by_metal, *by_balls)])
        return cls(fields, clean / white, _blurred(soft, scene) / white)


def pixel_bound(scene: Scene, guide: Guide, changes: Changes) -> Bound:
    """Of one scene, for its target at the default depth."""
    v, u = np.nonzero(np.max(np.abs(changes.fields), axis=0) > _LEAST_SIGNAL)
    seen, raw = changes.fields[:, v, u].T, np.column_stack((u, v)).astype(np.float64)
    parts = [slice(start, start + _CHUNK) for start in range(0, len(raw), _CHUNK)]
    columns = np.concatenate([np.einsum("nk,nkp->np", seen[part], field_weights(scene, raw[part])) for part in parts])
    noise = noise_variance(changes.clean[v, u], scene)
    return bound_of(scene, guide, (columns / noise[:, None]).T @ columns)


def field_weights(scene: Scene, raw: Array) -> Array:
    """How much of each field (n, k, p) an error of each of the p parameters makes, at raw pixels (n, 2)."""
    terms = _distortion(scene).basis(raw) if scene.plate is not None else np.zeros((len(raw), 0))
    count = terms.shape[1]
    balls = 2 + _MOVES  # the first of their two fields
    weights = np.zeros((len(raw), balls + (2 if count else 0), _CAMERA + (_PLATE + 2 * count if count else 0)))
    weights[:, 2:balls, :_MOVES] = np.eye(_MOVES)
    weights[:, [0, 1], [_MOVES, _MOVES + 1]] = -1.0
    if count:
        x, y = ((scene.distortion.ideal_from_raw(raw) - scene.distortion.centre_px) / scene.distortion.centre_px).T
        weights[:, [balls, balls + 1], [_CAMERA, _CAMERA + 1]] = -1.0
        weights[:, balls, _CAMERA + 2], weights[:, balls + 1, _CAMERA + 2] = y, -x
        for axis in (0, 1):
            first = _CAMERA + _PLATE + axis * count
            weights[:, axis, first : first + count] = weights[:, balls + axis, first : first + count] = terms
    return weights


def bound_of(scene: Scene, guide: Guide, information: Array) -> Bound:
    """The bound by an image's information (p, p) of the parameters."""
    count = len(information)
    information = information + np.diag(1.0 / _prior_sd(count, guide) ** 2)
    scale = 1.0 / np.sqrt(np.diag(information))
    covariance = np.linalg.inv(information * np.outer(scale, scale)) * np.outer(scale, scale)
    by_parameter = _error_jacobian(scene, guide, count)
    spread = by_parameter @ covariance @ by_parameter.T
    angle_rad, position_mm = np.sqrt(np.trace(spread[:3, :3])), np.sqrt(np.trace(spread[3:, 3:]))
    return Bound(float(np.degrees(angle_rad)), float(position_mm))


def _prior_sd(count: int, guide: Guide) -> Array:
    sd = np.full(count, _FREE_SD_PX)
    sd[:3], sd[3:6], sd[6] = 1.0, 100.0, _DISTANCE_SD_MM
    sd[7:_MOVES] = guide.tolerance.radius_sd_mm, guide.tolerance.radius_sd_mm, guide.tolerance.separation_sd_mm
    sd[_MOVES:_CAMERA] = _CENTRE_SD_PX
    return sd


def noise_variance(signal: Array, scene: Scene) -> Array:
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
    """Derivatives of the wires' light by the parameters that move them."""
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
    small_mm, big_mm, apart_mm = (float(off) for off in step[7:_MOVES])
    shape = replace(
        placed.shape,
        small_radius_mm=placed.shape.small_radius_mm + small_mm,
        big_radius_mm=placed.shape.big_radius_mm + big_mm,
        separation_mm=placed.shape.separation_mm + apart_mm,
    )
    return replace(scene, guides=(PlacedGuide(shape, pose),), camera=camera)


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
    guide_from_goal, _ = goal(_view(_moved(scene, step), step[_MOVES:_CAMERA]), pixel + bent)
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

"""From intensity behind the patient to the numbers in the file: blur, quanta, field of view, display."""

import cv2
import numpy as np
from numpy.typing import NDArray

from simulator.carm.scene import Exposure, Scene

Array32 = NDArray[np.float32]

_WHITE = 0.91  # display value of the bright end
_BRIGHT_PERCENTILE = 99.0
_FIELD_EDGE_PX = 2.5  # the round field ends this far inside the image's edge
_LEAKAGE = 0.004  # what passes the collimator's blades
_GRAIN_PX = 0.42  # sd of the spread that a quantum makes behind the screen


def develop(intensity: Array32, scene: Scene, rng: np.random.Generator) -> NDArray[np.uint8] | NDArray[np.uint16]:
    """Pixels of a scene from its noiseless intensity (rows, columns)."""
    exposure = scene.exposure
    spread = _blurred(intensity, exposure)
    if exposure.collimator_px is not None:
        spread *= _blades(spread.shape, exposure.collimator_px)
    field = _field(scene)
    spread /= np.percentile(spread[::4, ::4][field[::4, ::4]], _BRIGHT_PERCENTILE)
    shown = _WHITE * exposure.gain * np.power(_noisy(spread, exposure, rng), np.float32(exposure.gamma))
    return _quantised(np.where(field, shown, np.float32(0.0)), exposure)


def _blurred(intensity: Array32, exposure: Exposure) -> Array32:
    spread = cv2.GaussianBlur(intensity, (0, 0), exposure.blur_px)
    if exposure.motion_px > 0.0:
        spread = cv2.filter2D(spread, -1, _streak(exposure.motion_px, exposure.motion_rad))
    return np.asarray(spread, dtype=np.float32)


def _streak(length_px: float, angle_rad: float) -> Array32:
    """A kernel that moves the image along a line of this length."""
    half = int(np.ceil(length_px / 2.0)) + 1
    kernel = np.zeros((2 * half + 1, 2 * half + 1), dtype=np.float32)
    for along in np.linspace(-length_px / 2.0, length_px / 2.0, 8 * half):
        kernel[round(half + along * np.sin(angle_rad)), round(half + along * np.cos(angle_rad))] += 1.0
    streak: Array32 = kernel / kernel.sum()
    return streak


def _blades(shape: tuple[int, ...], blades_px: tuple[float, float, float, float]) -> Array32:
    left, right, top, bottom = blades_px
    v, u = np.ogrid[: shape[0], : shape[1]]
    open_part = (u >= left) & (u <= right) & (v >= top) & (v <= bottom)
    return np.where(open_part, np.float32(1.0), np.float32(_LEAKAGE))


def _field(scene: Scene) -> NDArray[np.bool_]:
    """Where the detector sees anything."""
    camera = scene.camera
    if not scene.intensifier:
        return np.ones((camera.rows, camera.columns), dtype=np.bool_)
    radius = min(camera.rows, camera.columns) / 2.0 - _FIELD_EDGE_PX
    u, v = np.arange(camera.columns) - (camera.columns - 1) / 2.0, np.arange(camera.rows) - (camera.rows - 1) / 2.0
    inside: NDArray[np.bool_] = u**2 + v[:, None] ** 2 < radius**2
    return inside


def _noisy(spread: Array32, exposure: Exposure, rng: np.random.Generator) -> Array32:
    """Quantum noise: its variance is the signal's share of the quanta."""
    grain = rng.standard_normal(spread.shape, dtype=np.float32)
    grain = np.asarray(cv2.GaussianBlur(grain, (0, 0), _GRAIN_PX), dtype=np.float32)
    noise = grain * np.sqrt(spread / np.float32(exposure.photons))
    noisy: Array32 = np.maximum(spread + noise, np.float32(0.0))
    return noisy


def _quantised(shown: Array32, exposure: Exposure) -> NDArray[np.uint8] | NDArray[np.uint16]:
    highest = 2**exposure.bits - 1
    levels: Array32 = np.rint(np.clip(shown, 0.0, 1.0) * highest)
    if exposure.crop_px is not None:
        left, right, top, bottom = exposure.crop_px
        levels = levels[top : bottom + 1, left : right + 1]
    return levels.astype(np.uint8) if exposure.bits == 8 else levels.astype(np.uint16)

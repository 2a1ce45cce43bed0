"""The truth of a rendered image, in the format of the sample images."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from simulator.carm.scene import Scene

_FIRST_PX, _LAST_PX, _POINTS = 120.0, 903.0, 9


def truth_of(scene: Scene) -> dict[str, Any]:
    """All that a sample's JSON holds; pixels count from the corner of what was handed out."""
    camera, corner = scene.camera, _corner(scene)
    target = np.array(scene.target_ideal_px)
    return {
        "image": f"{scene.name}.png",
        "carm": "carm-intensifier.toml" if scene.intensifier else "carm-flat-panel.toml",
        "guide": "guide.toml",
        "group": scene.group,
        "source_to_image_distance_mm": camera.source_to_image_mm,
        "pixel_size_mm": camera.pixel_mm,
        "principal_point_ideal_px": [camera.principal_u_px - corner[0], camera.principal_v_px - corner[1]],
        "source_from_guide_mm": scene.guides[0].source_from_guide.tolist() if scene.guides else None,
        "target_ideal_px": (target - corner).tolist(),
        "target_raw_px": (scene.distortion.raw_from_ideal(target) - corner).tolist(),
        "ideal_from_raw_px": _pairs(scene, corner),
    }


def _pairs(scene: Scene, corner: NDArray[np.float64]) -> list[list[float]]:
    """A lattice of raw pixels, each beside its ideal one."""
    axis = np.linspace(_FIRST_PX, _LAST_PX, _POINTS)
    raw = np.stack(np.meshgrid(axis, axis), axis=-1).reshape(-1, 2)
    ideal = scene.distortion.ideal_from_raw(raw)
    pairs: list[list[float]] = np.round(np.hstack([raw - corner, ideal - corner]), 4).tolist()
    return pairs


def _corner(scene: Scene) -> NDArray[np.float64]:
    crop = scene.exposure.crop_px
    return np.zeros(2) if crop is None else np.array([crop[0], crop[2]], dtype=np.float64)

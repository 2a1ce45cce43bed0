"""What goes to 3D Slicer, as OpenIGTLink messages; frames and units as everywhere (mm, the arm's base)."""

import json
from typing import Any

import numpy as np
import pyigtl
from numpy.typing import NDArray

from robot.frames import Transform

# Device names, as nodes in 3D Slicer are called.
GUIDE, GOAL, TARGET = "BaseFromGuide", "BaseFromGoal", "BaseFromTarget"
STATUS, IMAGE = "CoaxialStatus", "CoaxialImage"


def transform(name: str, base_from_it: Transform) -> bytes:
    """A pose in the arm's base, mm."""
    return bytes(pyigtl.TransformMessage(np.asarray(base_from_it, dtype=np.float64), device_name=name).pack())


def status(state: dict[str, Any]) -> bytes:
    """Case, state and version as JSON; no patient data leaves this way."""
    return bytes(pyigtl.StringMessage(json.dumps(state, sort_keys=True), device_name=STATUS).pack())


def image(pixels: NDArray[np.uint16]) -> bytes:
    """An X-ray image (rows, columns) as one slice; its pixels are its millimetres, for it has no place in a room."""
    return bytes(pyigtl.ImageMessage(pixels[np.newaxis], device_name=IMAGE).pack())


def target_beyond(base_from_goal: Transform, separation_mm: float, depth_mm: float) -> Transform:
    """The target on the goal's axis, `depth_mm` below the big ring: towards the source, against z."""
    goal_from_target = np.eye(4)
    goal_from_target[2, 3] = -(separation_mm + depth_mm)
    return np.asarray(base_from_goal @ goal_from_target)

"""Uncalibrated image-based visual servoing: the Jacobian from exploratory moves, kept by Broyden's update.

Features are the centres of both rings in straightened pixels; they must come to lie on the target's pixel. Neither the
C-arm nor the tool is calibrated. The image is modelled by its geometry and the finder's noise.
"""

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from benchmarks.side_by_side.theatre import GuideErrors, Theatre
from simulator.carm.stand import Stand

Array = NDArray[np.float64]

_FEATURE_SD_PX = 0.05  # of a ring's centre, as this project measures it: see the table of finders
_PROBES = np.diag([3.0, 3.0, np.deg2rad(1.0), np.deg2rad(1.0)])  # mm and rad in the guide frame, one exposure each
_ARRIVED_PX = 0.5  # both centres within: 0.1 mm at the target
_MOST_EXPOSURES = 30


def place_by_servoing(theatre: Theatre, gain: float) -> GuideErrors:
    """Move until the rings' centres cover the target's pixel, or the exposures are used up."""
    stand = theatre.stand(theatre.angles)
    theatre.lead_by_hand(stand)
    aim = theatre.picked(theatre.expose(stand), theatre.pedicle.target_in_patient)
    theatre.exposures -= 1  # the target is picked in the first image of the servoing itself
    offset = _offset(theatre, stand, aim)
    jacobian = np.zeros((4, 4))
    for column, probe in enumerate(_PROBES):
        before, offset = offset, _stepped(theatre, stand, aim, probe)
        jacobian[:, column] = (offset - before) / probe[column]
    while np.abs(offset).max() > _ARRIVED_PX and theatre.exposures < _MOST_EXPOSURES:
        step = -gain * np.linalg.lstsq(jacobian, offset, rcond=None)[0]
        before, offset = offset, _stepped(theatre, stand, aim, step)
        scaled = step / np.diag(_PROBES) ** 2  # mm and rad weigh as they do in the probes
        jacobian += np.outer(offset - before - jacobian @ step, scaled) / (scaled @ step)
    return theatre.errors(stand)


def _stepped(theatre: Theatre, stand: Stand, aim: Array, step: Array) -> Array:
    """The offset after a step (4,) along and about the guide's x and y."""
    guide_from_goal = np.eye(4)
    guide_from_goal[:2, 3] = step[:2]
    guide_from_goal[:3, :3] = Rotation.from_rotvec([step[2], step[3], 0.0]).as_matrix()
    theatre.move(theatre.base_from_guide @ guide_from_goal)
    return _offset(theatre, stand, aim)


def _offset(theatre: Theatre, stand: Stand, aim: Array) -> Array:
    """Pixels (4,) by which the rings' centres miss the target's, from one exposure."""
    scene = theatre.expose(stand)
    pose, shape = scene.guides[0].source_from_guide, scene.guides[0].shape
    centres = np.array([[0.0, 0.0, 0.0], [*shape.big_centre_mm, -shape.separation_mm]])
    seen = scene.camera.project(centres @ pose[:3, :3].T + pose[:3, 3])
    offset: Array = (seen - aim).ravel() + _FEATURE_SD_PX * theatre.rng.standard_normal(4)
    return offset

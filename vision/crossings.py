"""What else darkens a patch of the image: the shadows of wires, balls and bead that are near enough to matter."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from vision.bands import Shadows
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.projection import View, project
from vision.shadows import Window, ball_shadows
from vision.wire_model import Wire, feet
from vision.wire_shape import ball_profile, wire_profile

Array = NDArray[np.float64]

CROSSING_SD = 0.5  # of what crosses, in its expected absorption


def crossings(
    view: View,
    guide: Guide,
    distortion: DistortionMap,
    shadows: Shadows,
    window: Window,
    corrected: Array,
    inside: NDArray[np.bool_],
    wires: Sequence[Wire],
) -> Array:
    """Columns (n, k), 1 at the middle of each shadow: the plate's balls together, then one for each wire that is there.

    Parameters
    ----------
    view, guide
        The present estimate.
    distortion : DistortionMap
        Places the raw pixels.
    shadows : Shadows
        Of this image.
    window : Window
        The patch.
    corrected : Array
        (n, 2), corrected pixels of those of the patch that matter.
    inside : NDArray[np.bool_]
        (rows * columns,): which these are.
    wires : Sequence[Wire]
        Those that may cross.
    """
    columns = []
    if len(shadows.balls_raw):
        ball = ball_profile(shadows.ball_radius_px, shadows.depth, shadows.blur_px)
        columns.append(ball_shadows(window, shadows.balls_raw, distortion, ball).ravel()[inside])
    for wire in wires:
        at = feet(view, guide, wire, corrected)
        on_line = (at.along > guide.line_start_mm) & (at.along < guide.line_end_mm)
        height = wire_profile(wire_radius_px(view, guide), shadows.depth, shadows.blur_px).heights(at.distance_px)
        columns.append(height * on_line if wire is Wire.LINE else height)
    return np.column_stack([column for column in columns if column.any()] or [np.zeros((len(corrected), 0))])


def bead_shadow(
    view: View, guide: Guide, distortion: DistortionMap, shadows: Shadows, window: Window, inside: NDArray[np.bool_]
) -> Array:
    """The bead's shadow (n, 1), 1 at its middle; (n, 0) where none is near."""
    none = np.zeros((int(inside.sum()), 0))
    if guide.bead is None:
        return none
    place = np.array([guide.bead.position_mm])
    depth_mm = float(view.source_from_guide[2, :3] @ place[0] + view.source_from_guide[2, 3])
    radius_px = view.intrinsics.alpha_x_px * guide.bead.diameter_mm / 2.0 / depth_mm
    profile = ball_profile(radius_px, shadows.depth * guide.bead.diameter_mm / guide.wire_diameter_mm, shadows.blur_px)
    centre = distortion.raw_from_corrected(project(view, place))
    column = ball_shadows(window, centre, distortion, profile).ravel()[inside]
    return column[:, None] if column.any() else none


def wire_radius_px(view: View, guide: Guide) -> float:
    """Of a wire's shadow, at the small ring's depth."""
    return guide.wire_diameter_mm / 2.0 * view.intrinsics.alpha_x_px / float(view.source_from_guide[2, 3])

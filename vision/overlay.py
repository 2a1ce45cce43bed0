"""What is drawn on the image: balls, rings, wires, bead, fiducials, line ends, residual arrows, target and bounds."""

import numpy as np
from numpy.typing import NDArray

from vision.conics import Ellipse
from vision.inspection import Aim, FoundView, Inspection
from vision.panel import Colour, Panel
from vision.projection import project
from vision.registered import Registration
from vision.uncertainty import CHI_SQUARE_95
from vision.wire_model import Wire

Array = NDArray[np.float64]

RESIDUALS_TIMES = 40.0  # exaggeration of the wires' residuals
BALLS_TIMES = 100.0  # of the balls': the map fits them to some hundredths of a pixel
BOUNDS_TIMES = 20.0  # of the bounds ellipse

WIRE_COLOURS: dict[Wire, Colour] = {
    Wire.SMALL_RING: (255, 220, 60),
    Wire.BIG_RING: (60, 170, 255),
    Wire.LINE: (255, 110, 255),
}
TEXT: Colour = (220, 220, 220)
REJECTED: Colour = (70, 70, 255)
_BEAD, _FIDUCIAL, _TARGET = (60, 255, 255), (255, 255, 255), (90, 255, 90)
_USED, _CANDIDATE = (120, 200, 120), (200, 160, 110)
_LONGEST_RESIDUAL_PX = 20.0  # of an arrow, corrected px: half a pixel of residual
_LONGEST_BALL_PX = 35.0  # the same: less than the lattice's spacing
MOST_CANDIDATES = 6  # ring candidates named, the best supported first


def draw_balls(panel: Panel, inspection: Inspection) -> None:
    """Balls with their residual arrows, those that the map left out in red; without a plate, what may be balls."""
    panel.circles(inspection.spots, 4.0, _CANDIDATE)
    balls = inspection.balls
    if balls is None or (isinstance(inspection.result, Registration) and not len(balls.raw)):
        return
    for kept, colour in ((True, _USED), (False, REJECTED)):
        chosen = balls.kept == kept
        panel.circles(balls.corrected[chosen], 4.0, colour)
        ends = balls.corrected[chosen] + _capped(BALLS_TIMES * balls.residual_px[chosen], _LONGEST_BALL_PX)
        panel.strokes(balls.corrected[chosen], ends, colour, 2)


def draw_rings(panel: Panel, inspection: Inspection) -> None:
    """Ring candidates with their support: other guides, and what was taken for a ring."""
    for ring in inspection.rings[:MOST_CANDIDATES]:
        points = ellipse_points(ring.ellipse)
        panel.path(points, _CANDIDATE, closed=True)
        panel.text(f"{ring.support:.2f}", points[0], _CANDIDATE)


def draw_wires(panel: Panel, found: FoundView) -> None:
    """The guide's wires as the view has them, and the bead at its place and at its mirror place."""
    for wire, colour in WIRE_COLOURS.items():
        points = found.wires.points[found.wires.wire == wire]
        panel.path(points, colour, closed=wire is not Wire.LINE)
    places = bead_places(found)
    panel.crosses(places[:1], 8.0, _BEAD)
    panel.circles(places[1:], 5.0, TEXT)
    for name, place, colour in zip(("bead", "mirror place"), places, (_BEAD, TEXT), strict=False):
        panel.text(name, place, colour, (10, -10))
    if found.bead_px is not None:
        panel.circles(found.bead_px[None], 12.0, _BEAD, 2)


def bead_places(found: FoundView) -> Array:
    """Corrected pixels (2, 2) of the bead's place and of its mirror place; (0, 2) for a guide without a bead."""
    if found.guide.bead is None:
        return np.zeros((0, 2))
    x, y, z = found.guide.bead.position_mm
    return project(found.view, np.array([[x, y, z], [x, -y, z]]))


def draw_residuals(panel: Panel, found: FoundView) -> None:
    """An arrow at each place measured, exaggerated; those without weight in red; the ends of the line as measured."""
    residuals = found.residuals
    if residuals is None:
        return
    steps = _capped(RESIDUALS_TIMES * residuals.residual_px[:, None] * residuals.normals, _LONGEST_RESIDUAL_PX)
    tips = residuals.model + steps
    for wire, colour in WIRE_COLOURS.items():
        on = (residuals.wire == wire) & (residuals.weight > 0.0)
        panel.strokes(residuals.model[on], tips[on], colour)
    out = residuals.weight == 0.0
    panel.strokes(residuals.model[out], tips[out], REJECTED)
    for end in found.line_ends:
        place = project(found.view, np.array([[end.x_mm, 0.0, 0.0]]))[0]
        panel.circles(place[None], 7.0, WIRE_COLOURS[Wire.LINE], 2)
        panel.text(f"end {end.excess_px:+.2f} px", place, WIRE_COLOURS[Wire.LINE], (10, 18))


def draw_fiducials(panel: Panel, registration: Registration) -> None:
    """The 12 fiducials."""
    panel.crosses(np.array(list(registration.fiducials_px.values())), 5.0, _FIDUCIAL)


def draw_aim(panel: Panel, aim: Aim) -> None:
    """The target, and where the axis passes it with 95 % probability, exaggerated."""
    panel.path(bounds_points(aim), _TARGET, 2, closed=True)
    panel.crosses(aim.pixel[None], 12.0, _TARGET, 2)
    panel.text("target", aim.pixel, _TARGET, (14, -14))


def bounds_points(aim: Aim) -> Array:
    """Places (n, 2) on the ellipse of where the axis passes the target, corrected pixels, BOUNDS_TIMES as large."""
    values, vectors = np.linalg.eigh(aim.covariance_px2)
    turn = np.linspace(0.0, 2.0 * np.pi, 90)
    unit = np.column_stack((np.cos(turn), np.sin(turn)))
    reach = BOUNDS_TIMES * np.sqrt(CHI_SQUARE_95 * np.maximum(values, 0.0))
    return np.asarray(aim.pixel + unit * reach @ vectors.T)


def ellipse_points(ellipse: Ellipse) -> Array:
    """Places (n, 2) around an ellipse, corrected pixels."""
    turn = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
    along = np.column_stack((np.cos(turn), np.sin(turn))) * ellipse.semi_axes_px
    cosine, sine = np.cos(ellipse.angle_rad), np.sin(ellipse.angle_rad)
    return np.asarray(along @ np.array([[cosine, sine], [-sine, cosine]]) + ellipse.centre_px)


def _capped(steps: Array, longest_px: float) -> Array:
    """Arrows (n, 2) no longer than needed to see that they are long: outliers would cover the rest."""
    length = np.linalg.norm(steps, axis=1, keepdims=True)
    return np.asarray(steps * np.minimum(1.0, longest_px / np.maximum(length, 1e-9)))

"""The room that the moving end of the arm takes up, as capsules: guide and holder, wrist, forearm, upper arm."""

from dataclasses import dataclass

import numpy as np

from robot.frames import Array, Transform
from robot.table import Range, Table, number, refuse_unknown, tables, text, vector

# Plausible ranges (H09), mm
_RADIUS_MM: Range = (2.0, 200.0)
_LENGTH_MM: Range = (0.0, 300.0)
_AWAY_MM: Range = (0.0, 600.0)  # from the guide's origin

# Housings of a UR5 (CB3) about the lines between its joints, from the maker's drawings, rounded up.
_WRIST_NAMES = ("wrist 1", "wrist 2", "wrist 3")
_WRIST_RADIUS_MM = 45.0
_FOREARM_RADIUS_MM = 55.0
_UPPER_ARM_RADIUS_MM = 60.0  # the housing of the elbow too
_SHOULDER_RADIUS_MM = 75.0
# From the plane through the base, along the axes of joints 2 to 4, which are parallel.
_UPPER_ARM_ASIDE_MM = 135.85
_FOREARM_ASIDE_MM = 16.15  # d4 less the offset of wrist 1
# The guide's body is a bundle of rods: this many leave no gap at a ninth of its radius.
_RODS = 36
_ROD_SHARE = 1.0 / 9.0


@dataclass(frozen=True, slots=True, eq=False)
class Capsules:
    """Everything within a radius of a straight piece, several of them in one frame.

    Attributes
    ----------
    names : (n,) of str
    starts_mm, ends_mm : (n, 3)
    radii_mm : (n,)
    """

    names: tuple[str, ...]
    starts_mm: Array
    ends_mm: Array
    radii_mm: Array


@dataclass(frozen=True, slots=True, eq=False)
class Envelope:
    """What the arm carries, in the guide frame: a cylinder about the guide's axis, rods, and the holder.

    Attributes
    ----------
    radius_mm : float
        Of the guide's body.
    below_mm, above_mm : float
        How far the body reaches from the small ring towards the patient (-z), and away from it.
    holder_radius_mm : float
        About the line from the flange to the guide.
    rods : Capsules
        What sticks out of the body.
    """

    radius_mm: float
    below_mm: float
    above_mm: float
    holder_radius_mm: float
    rods: Capsules


def read_envelope(table: Table) -> Envelope:
    """The table `envelope` of a TCP calibration file; ValueError in one line (H09)."""
    refuse_unknown(table, "[envelope]", {"radius_mm", "below_mm", "above_mm", "holder_radius_mm", "rod"})
    rods = tables(table, "rod")
    for rod in rods:
        refuse_unknown(rod, "[[envelope.rod]]", {"name", "start_mm", "end_mm", "radius_mm"})
    return Envelope(
        radius_mm=number(table, "radius_mm", _RADIUS_MM),
        below_mm=number(table, "below_mm", _LENGTH_MM),
        above_mm=number(table, "above_mm", _LENGTH_MM),
        holder_radius_mm=number(table, "holder_radius_mm", _RADIUS_MM),
        rods=Capsules(
            names=tuple(text(rod, "name") for rod in rods),
            starts_mm=np.array([vector(rod, "start_mm", _AWAY_MM) for rod in rods]).reshape(-1, 3),
            ends_mm=np.array([vector(rod, "end_mm", _AWAY_MM) for rod in rods]).reshape(-1, 3),
            radii_mm=np.array([number(rod, "radius_mm", _RADIUS_MM) for rod in rods]),
        ),
    )


def carried(envelope: Envelope, flange_from_guide: Transform) -> Capsules:
    """Capsules of guide and holder in the guide frame; they cover the whole surface of the body."""
    body, rods = _body(envelope), envelope.rods
    flange_mm = -flange_from_guide[:3, :3].T @ flange_from_guide[:3, 3]
    return Capsules(
        names=(*body.names, "holder", *rods.names),
        starts_mm=np.vstack([body.starts_mm, flange_mm, rods.starts_mm]),
        ends_mm=np.vstack([body.ends_mm, np.zeros(3), rods.ends_mm]),
        radii_mm=np.concatenate([body.radii_mm, [envelope.holder_radius_mm], rods.radii_mm]),
    )


def links(base_from_links: Array) -> Capsules:
    """Capsules from shoulder to wrist in the base frame, from the (7, 4, 4) frames of the links in mm.

    The base itself does not move, and stands on what the room file may hold.
    """
    joints_mm, axis = base_from_links[:, :3, 3], base_from_links[3, :3, 2]
    near, far = _FOREARM_ASIDE_MM * axis, _UPPER_ARM_ASIDE_MM * axis
    shoulder_mm, elbow_mm, wrist_mm = joints_mm[1:4]
    return Capsules(
        names=("shoulder", "upper arm", "elbow", "forearm", *_WRIST_NAMES),
        starts_mm=np.vstack([shoulder_mm, shoulder_mm + far, elbow_mm + far, elbow_mm + near, joints_mm[3:6]]),
        ends_mm=np.vstack([shoulder_mm + far, elbow_mm + far, elbow_mm + near, wrist_mm + near, joints_mm[4:7]]),
        radii_mm=np.array(
            [_SHOULDER_RADIUS_MM, *[_UPPER_ARM_RADIUS_MM] * 2, _FOREARM_RADIUS_MM, *[_WRIST_RADIUS_MM] * 3]
        ),
    )


def _body(envelope: Envelope) -> Capsules:
    """Rods parallel to the guide's axis, so placed that the middle between two lies on the body's surface."""
    turn = np.pi / _RODS
    rod_mm = envelope.radius_mm * _ROD_SHARE
    circle_mm = envelope.radius_mm * np.cos(turn) - np.sqrt(rod_mm**2 - (envelope.radius_mm * np.sin(turn)) ** 2)
    angles = 2.0 * turn * np.arange(_RODS)
    around = circle_mm * np.column_stack([np.cos(angles), np.sin(angles), np.zeros(_RODS)])
    return Capsules(
        names=("guide",) * _RODS,
        starts_mm=around - np.array([0.0, 0.0, envelope.below_mm]),
        ends_mm=around + np.array([0.0, 0.0, envelope.above_mm]),
        radii_mm=np.full(_RODS, rod_mm),
    )

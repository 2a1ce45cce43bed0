"""How near the arm comes to the shapes of the room along a path (H12).

Between two samples no point comes nearer than at the nearer of the two, less how far it can be from both. That is
subtracted from every clearance, so that nothing slips through between samples.
"""

from dataclasses import dataclass, replace

import numpy as np

from robot.envelope import Capsules, Envelope, carried, links
from robot.frames import Array, Transform
from robot.kinematics import link_frames
from robot.room_shapes import RoomShapes
from robot.shapes import segment_distance


@dataclass(frozen=True, slots=True)
class Nearest:
    """Where a path comes nearest to a shape: between `segment` and the next sample."""

    segment: int
    part: str  # of the arm
    shape: str
    clearance_mm: float


@dataclass(frozen=True, slots=True, eq=False)
class Sweep:
    """Clearances along a path.

    Attributes
    ----------
    shapes : (shapes,) of str
    parts : (parts,) of str
        Of the arm, one for each capsule.
    clearances_mm : (segments, parts, shapes)
        Lower bounds for everything between two samples.
    start_mm : (parts, shapes)
        Lower bounds for the beginning of the path.
    """

    shapes: tuple[str, ...]
    parts: tuple[str, ...]
    clearances_mm: Array
    start_mm: Array

    @property
    def nearest(self) -> Nearest:
        """Of the whole path."""
        return self._at(np.unravel_index(int(self.clearances_mm.argmin()), self.clearances_mm.shape))

    def on_segment(self, segment: int) -> Nearest:
        """Of one segment."""
        part, shape = np.unravel_index(int(self.clearances_mm[segment].argmin()), self.clearances_mm.shape[1:])
        return self._at((segment, part, shape))

    def worst_against(self, needed_mm: Array) -> tuple[Nearest, float]:
        """Where the most is missing of what each of the (parts, shapes) needs, and what is needed there, mm."""
        left_mm = self.clearances_mm - needed_mm
        segment, part, shape = np.unravel_index(int(left_mm.argmin()), left_mm.shape)
        return self._at((segment, part, shape)), float(needed_mm[part, shape])

    def _at(self, place: tuple[np.intp | int, ...]) -> Nearest:
        segment, part, shape = (int(index) for index in place)
        return Nearest(segment, self.parts[part], self.shapes[shape], float(self.clearances_mm[segment, part, shape]))


def sweep(
    base_from_guides: Array, joints_rad: Array, flange_from_guide: Transform, envelope: Envelope, room: RoomShapes
) -> Sweep:
    """Clearances of guide, holder and arm along a path.

    Parameters
    ----------
    base_from_guides : (samples, 4, 4), mm
        Poses of the TCP, at least two.
    joints_rad : (samples, 6)
        The arm at each.

    Notes
    -----
    The links' places are those of the nominal arm, carried along with the difference between its TCP and the real one.
    """
    guide = carried(envelope, flange_from_guide)
    steps = [
        _joined(_placed(guide, pose), links(_real_links(pose, joints, flange_from_guide)))
        for pose, joints in zip(base_from_guides, joints_rad, strict=True)
    ]
    starts_mm, ends_mm = np.stack([one.starts_mm for one in steps]), np.stack([one.ends_mm for one in steps])
    distances_mm = np.stack([segment_distance(shape, starts_mm, ends_mm) for shape in room.shapes], axis=-1)
    at_samples_mm = distances_mm - steps[0].radii_mm[:, None]
    slack_mm = np.maximum(_slack(starts_mm), _slack(ends_mm))[..., None]
    return Sweep(
        shapes=tuple(shape.name for shape in room.shapes),
        parts=steps[0].names,
        clearances_mm=np.minimum(at_samples_mm[:-1], at_samples_mm[1:]) - slack_mm,
        start_mm=at_samples_mm[0] - slack_mm.max(axis=0),
    )


def _real_links(base_from_guide: Transform, joints_rad: Array, flange_from_guide: Transform) -> Array:
    """Frames of the links (7, 4, 4), shifted so that the last one carries the guide where it really is."""
    nominal = link_frames(joints_rad)
    real_from_nominal = base_from_guide @ np.linalg.inv(nominal[-1] @ flange_from_guide)
    return np.asarray(real_from_nominal @ nominal)


def _placed(capsules: Capsules, base_from_guide: Transform) -> Capsules:
    rotation, origin_mm = base_from_guide[:3, :3], base_from_guide[:3, 3]
    return replace(
        capsules,
        starts_mm=capsules.starts_mm @ rotation.T + origin_mm,
        ends_mm=capsules.ends_mm @ rotation.T + origin_mm,
    )


def _joined(a: Capsules, b: Capsules) -> Capsules:
    return Capsules(
        names=(*a.names, *b.names),
        starts_mm=np.vstack([a.starts_mm, b.starts_mm]),
        ends_mm=np.vstack([a.ends_mm, b.ends_mm]),
        radii_mm=np.concatenate([a.radii_mm, b.radii_mm]),
    )


def _slack(points_mm: Array) -> Array:
    """How far (samples, n, 3) points go at most from the nearer of two samples, (samples - 1, n) mm.

    A way whose step changes by M from one pair of samples to the next leaves its chord by M / 8; M is only known at
    the samples, so four times that is taken.
    """
    chords = np.diff(points_mm, axis=0)
    change_mm = np.linalg.norm(np.diff(chords, axis=0), axis=-1)
    padded_mm = np.pad(change_mm, ((1, 1), (0, 0)))
    return np.asarray(np.linalg.norm(chords, axis=-1) / 2.0 + np.maximum(padded_mm[:-1], padded_mm[1:]) / 2.0)

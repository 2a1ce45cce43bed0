"""The C-arm as somebody positioned it: what its dials say, and where source and detector truly are."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.carm.camera import Camera
from simulator.carm.distortion import NO_DISTORTION, Distortion, draw_distortion
from simulator.carm.geometry import Angles, room_from_source, sag_in_room, sag_on_detector_mm
from simulator.devices import NominalCarm
from simulator.planted import Planted
from simulator.truth import Truth

Array = NDArray[np.float64]

SIDE_PX = 1024
_MIDDLE_PX = (SIDE_PX - 1) / 2.0


@dataclass(frozen=True, slots=True, eq=False)
class Stand:
    """One position of the C-arm; `turned_rad` is a turn about the table's axis that no dial shows."""

    angles: Angles
    isocentre_in_room: Array
    nominal: NominalCarm
    truth: Truth
    planted: Planted
    turned_rad: float = 0.0

    def room_from_source(self) -> Array:
        """True pose of the source frame, 4x4, mm."""
        turns = Rotation.from_rotvec(self.planted.angle_error_rad) * Rotation.from_rotvec([self.turned_rad, 0.0, 0.0])
        isocentre = self.isocentre_in_room + sag_in_room(self.angles, self.truth.carm.sag_mm)
        return room_from_source(turns.apply(self.angles.beam_in_room), isocentre)

    def camera(self) -> Camera:
        """True intrinsics: distance and foot of the normal are off, and sway with the angles."""
        pixel_mm = self.nominal.field_of_view_mm / SIDE_PX
        sway_u, sway_v = sag_on_detector_mm(self.angles, self.truth.carm.sag_mm)
        offset_u, offset_v = self.planted.principal_offset_px
        return Camera(
            source_to_image_mm=self.planted.source_to_image_mm,
            pixel_mm=pixel_mm,
            principal_u_px=_MIDDLE_PX + offset_u + sway_u / pixel_mm,
            principal_v_px=_MIDDLE_PX + offset_v + sway_v / pixel_mm,
            rows=SIDE_PX,
            columns=SIDE_PX,
        )

    def distortion(self) -> Distortion:
        """Another one in every pose, the same while the dials stay."""
        if not self.nominal.intensifier:
            return NO_DISTORTION
        dials = [round(float(np.rad2deg(angle)) * 10.0) % 3600 for angle in self.angles.from_vertical_rad]
        return draw_distortion(np.random.default_rng([self.truth.seed, *dials]))

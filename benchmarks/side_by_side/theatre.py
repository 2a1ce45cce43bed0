"""A light simulation of the room: the simulator's own arm, C-arm and errors, without processes and HTTP."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simulator.by_eye import guide_in_beam, led_by_hand
from simulator.carm.geometry import Angles, angles_of
from simulator.carm.plate import draw_plate
from simulator.carm.quick_render import render_quickly
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from simulator.carm.stand import Stand
from simulator.devices import read_mounting, read_nominal_carm, read_shape
from simulator.frames import PARKED_RAD, ROOM_FROM_BASE, inverse
from simulator.kinematics import NOMINAL_UR5, base_from_flange, jacobian, planted_links, solve_joints
from simulator.patient import build_patient
from simulator.planted import plant
from simulator.truth import read_truth

Array = NDArray[np.float64]

PICK_SD_PX = 0.5  # of a person who points at anatomy, in every image in which something is pointed at
_SETTLING_TRAVEL_MM = 2.0  # a shorter motion keeps part of the offset with which the arm stood
_REPEATABILITY_RAD = 2e-4


@dataclass(frozen=True, slots=True)
class GuideErrors:
    """The guide's axis against the planned path, and its distance from the true target."""

    angle_deg: float
    position_mm: float


class Theatre:
    """One patient, one planned path, one arm with planted errors; directions and signs are the seed's."""

    def __init__(self, seed: int) -> None:
        self.truth = replace(read_truth(), seed=seed)
        self.nominal, self.mounting = read_nominal_carm(), read_mounting()
        self.planted = plant(self.truth, read_shape(), self.mounting.flange_from_guide, self.nominal.source_to_image_mm)
        self.patient = build_patient(seed)
        self.rng = np.random.default_rng([seed, 1])
        self.exposures = 0
        self.moves = 0
        self._plate = draw_plate(self.rng)
        self._links = planted_links(NOMINAL_UR5, self.truth.arm.kinematic_error_mm, seed)
        self._joints: Array = np.array(PARKED_RAD)
        self._offset = self._drawn_offset()
        names = sorted(self.patient.pedicles)
        self.pedicle = self.patient.pedicles[names[seed % len(names)]]
        self.angles = angles_of(self.pedicle.entry_in_patient, self.pedicle.target_in_patient)

    def stand(self, angles: Angles) -> Stand:
        """The C-arm turned and centred by eye."""
        aside = self.truth.carm.centring_error_mm * self.rng.standard_normal(3)
        return Stand(
            angles, self.in_room(self.pedicle.target_in_patient) + aside, self.nominal, self.truth, self.planted
        )

    def in_room(self, point_in_patient: Array) -> Array:
        """A point (3,) of the patient, mm."""
        moved: Array = (self.patient.room_from_patient @ np.append(point_in_patient, 1.0))[:3]
        return moved

    def lead_by_hand(self, stand: Stand) -> None:
        """The guide into the beam by eye."""
        aim = guide_in_beam(stand.room_from_source()[:3, 3], self.in_room(self.pedicle.target_in_patient))
        reached = inverse(ROOM_FROM_BASE) @ led_by_hand(aim, self.truth.hand, self.rng)
        self.move(reached)
        self.moves -= 1  # led, not commanded

    @property
    def base_from_guide(self) -> Array:
        """4x4, mm, as the controller and the calibration have it."""
        return base_from_flange(NOMINAL_UR5, self._joints) @ self.mounting.flange_from_guide

    @property
    def room_from_guide(self) -> Array:
        """4x4, mm, where the guide is."""
        flange = base_from_flange(self._links, self._joints + self._offset)
        pose: Array = ROOM_FROM_BASE @ flange @ self.planted.flange_from_guide
        return pose

    def move(self, base_from_goal: Array) -> None:
        """Drive the guide to where the controller thinks that a pose is; ValueError if the arm cannot."""
        joints = solve_joints(NOMINAL_UR5, base_from_goal @ inverse(self.mounting.flange_from_guide), self._joints)
        if joints is None:
            raise ValueError("the arm cannot reach a pose")
        travel_mm = float(np.linalg.norm(base_from_goal[:3, 3] - self.base_from_guide[:3, 3]))
        self._joints = joints
        settled = min(1.0, travel_mm / _SETTLING_TRAVEL_MM)
        self._offset = self._offset + settled * (self._drawn_offset() - self._offset)
        self.moves += 1

    def touch(self, point_in_base: Array) -> Array:
        """The controller's own figure (3,) for the tip's place while it touches a point of the base's true frame."""
        pose = self.base_from_guide
        for _ in range(4):  # by sight: what is true is corrected until the tip is there
            pose = pose.copy()
            pose[:3, 3] += point_in_base - (inverse(ROOM_FROM_BASE) @ self.room_from_guide)[:3, 3]
            self.move(pose)
        tip: Array = self.base_from_guide[:3, 3]
        return tip

    def expose(self, stand: Stand) -> Scene:
        """What an X-ray from here shows; it counts."""
        self.exposures += 1
        source_from_room = inverse(stand.room_from_source())
        camera = stand.camera()
        return Scene(
            camera=camera,
            guides=(PlacedGuide(self.planted.shape, source_from_room @ self.room_from_guide),),
            target_ideal_px=(camera.principal_u_px, camera.principal_v_px),
            distortion=stand.distortion(),
            plate=self._plate,
            body=self.patient.body,
            source_from_patient=source_from_room @ self.patient.room_from_patient,
            exposure=Exposure(self.truth.carm.photons),
        )

    def pixels(self, scene: Scene) -> NDArray[np.uint8] | NDArray[np.uint16]:
        """The rendered image."""
        return render_quickly(scene, self.exposures).pixels

    def picked(self, scene: Scene, point_in_patient: Array) -> Array:
        """Ideal pixel (2,) at which a person points for a point of the patient."""
        pose = scene.source_from_patient
        exact = scene.camera.project(pose[:3, :3] @ point_in_patient + pose[:3, 3])
        return exact + PICK_SD_PX * self.rng.standard_normal(2)

    def errors(self, stand: Stand | None = None) -> GuideErrors:
        """Against the ray from the source of a view to the target, or without a view against the planned path."""
        pose, target = self.room_from_guide, self.in_room(self.pedicle.target_in_patient)
        if stand is None:
            wanted = self.in_room(self.pedicle.entry_in_patient) - target
        else:
            wanted = target - stand.room_from_source()[:3, 3]
        axis = pose[:3, 2]
        angle_rad = np.arctan2(np.linalg.norm(np.cross(axis, wanted)), axis @ wanted)
        aside_mm = np.linalg.norm(np.cross(target - pose[:3, 3], axis))
        return GuideErrors(float(np.rad2deg(angle_rad)), float(aside_mm))

    def _drawn_offset(self) -> Array:
        spread = np.repeat([self.truth.arm.repeatability_mm, _REPEATABILITY_RAD], 3) / np.sqrt(3.0)
        shift = self.rng.standard_normal(6) * spread
        offset: Array = np.linalg.pinv(jacobian(self._links, self._joints), rcond=1e-2) @ shift
        return offset

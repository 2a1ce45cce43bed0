"""Everything in the room in one place: patient, C-arm, arm and guide."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from simulator.breathing import breathing_shift, until_expiration_s
from simulator.by_eye import guide_in_beam, led_by_hand
from simulator.carm.geometry import Angles, angles_of
from simulator.carm.guide import GuideShape, Part
from simulator.carm.plate import draw_plate
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from simulator.carm.stand import Stand
from simulator.cart import Cart
from simulator.controller import ControllerControl, ControllerState
from simulator.ct.patient import patient_of
from simulator.devices import INTENSIFIER_FILE, read_mounting, read_nominal_carm, read_shape
from simulator.faults import (
    ANATOMY_SHIFT_MM,
    BASE_PUSH_MM,
    CARM_SHIFT_MM,
    CARM_TURN_DEG,
    GUIDE_SCALE,
    LOW_DOSE_SHARE,
    RoomFault,
)
from simulator.frames import inverse
from simulator.patient import Patient, build_patient
from simulator.pedicle import Pedicle
from simulator.planted import plant
from simulator.truth import Truth

Array = NDArray[np.float64]

_DISPLAY_GAMMA = 0.8
_BITS = 16


@dataclass(frozen=True, slots=True)
class GuideErrors:
    """How far the guide's axis is from the true path: the ray from source to target, and the target itself."""

    angle_rad: float
    position_mm: float


class Room:
    """The room's state; every call may come from any thread."""

    def __init__(self, controller: ControllerControl, truth: Truth, now_s: Callable[[], float] = time.time) -> None:
        self.controller, self.truth = controller, truth
        self.nominal = read_nominal_carm(INTENSIFIER_FILE)
        self.patient = _patient(truth)
        self.planted = plant(truth, read_shape(), read_mounting().flange_from_guide, self.nominal.source_to_image_mm)
        self.faults: frozenset[RoomFault] = frozenset()
        self._lock = threading.RLock()
        self._now_s = now_s
        self._rng = np.random.default_rng(truth.seed)
        self._plate = draw_plate(self._rng)
        self._cart = Cart(self.planted.cart_settling)
        first = next(iter(self.patient.pedicles.values()))
        self._stand = self._stood(angles_of(first.entry_in_patient, first.target_in_patient), first)

    def pedicle(self, name: str) -> Pedicle:
        """A planned path; KeyError if there is none of this name."""
        return self.patient.pedicles[name]

    @property
    def stand(self) -> Stand:
        """The C-arm as it stands, a fault included."""
        turned_deg = CARM_TURN_DEG if RoomFault.CARM_TURNED in self.faults else 0.0
        shift_mm = CARM_SHIFT_MM if RoomFault.CARM_SHIFTED in self.faults else 0.0
        isocentre = self._stand.isocentre_in_room + np.array([shift_mm, 0.0, 0.0])
        return replace(self._stand, turned_rad=float(np.deg2rad(turned_deg)), isocentre_in_room=isocentre)

    @property
    def dose_share(self) -> float:
        """Of a normal exposure."""
        return LOW_DOSE_SHARE if RoomFault.LOW_DOSE in self.faults else 1.0

    def position(self, angles: Angles, centred_on: str | None = None) -> None:
        """Turn the C-arm and centre it by eye on a pedicle, without a name on that whose path fits the angles best."""
        with self._lock:
            pedicle = self._fitting(angles) if centred_on is None else self.pedicle(centred_on)
            self._stand = self._stood(angles, pedicle)

    def until_expiration_s(self) -> float:
        """How long somebody waits who exposes with the patient's breath at rest."""
        return until_expiration_s(self.truth.patient, self._now_s())

    def scene(self) -> Scene:
        """What an exposure would see now."""
        with self._lock:
            stand, arm = self.stand, self.controller.state()
            source_from_room = inverse(stand.room_from_source())
            guide = PlacedGuide(self._shape(), source_from_room @ self._room_from_guide(arm))
            camera, distortion = stand.camera(), stand.distortion()
            raw = distortion.raw_from_ideal(camera.project(guide.source_from_guide[:3, 3]))
            if np.all(raw > 0.0) and np.all(raw < (camera.columns, camera.rows)):
                self._cart.seen(arm)
            return Scene(
                camera=camera,
                guides=(guide,),
                target_ideal_px=(camera.principal_u_px, camera.principal_v_px),
                distortion=distortion,
                plate=self._plate if self.nominal.intensifier and RoomFault.NO_PLATE not in self.faults else None,
                intensifier=self.nominal.intensifier,
                body=self.patient.body,
                source_from_patient=source_from_room @ self._room_from_patient(self._now_s()),
                exposure=Exposure(self.truth.carm.photons * self.dose_share, gamma=_DISPLAY_GAMMA, bits=_BITS),
            )

    def approach(self, name: str) -> Array:
        """Where somebody would lead the guide by eye: `base_from_goal` (4x4, mm), in the beam above a pedicle."""
        with self._lock:
            aim = guide_in_beam(self.stand.room_from_source()[:3, 3], self._target_in_room(name))
            reached = led_by_hand(aim, self.truth.hand, self._rng)
            return inverse(self._room_from_base(self.controller.state())) @ reached

    def errors(self, name: str) -> GuideErrors:
        """The guide against the true ray through a true target, at the patient's mean breath."""
        with self._lock:
            room_from_guide = self._room_from_guide(self.controller.state())
            target, source = self._target_in_room(name), self.stand.room_from_source()[:3, 3]
        axis, ray = room_from_guide[:3, 2], (target - source) / np.linalg.norm(target - source)
        angle = np.arctan2(np.linalg.norm(np.cross(axis, ray)), axis @ ray)
        aside = np.cross(target - room_from_guide[:3, 3], axis)
        return GuideErrors(float(angle), float(np.linalg.norm(aside)))

    def inject(self, fault: RoomFault) -> None:
        """Make something wrong until it is cleared."""
        with self._lock:
            self.faults |= {fault}

    def clear(self, fault: RoomFault | None = None) -> None:
        """Make one thing right again, or all."""
        with self._lock:
            self.faults = frozenset() if fault is None else self.faults - {fault}

    def _stood(self, angles: Angles, pedicle: Pedicle) -> Stand:
        target = (self.patient.room_from_patient @ np.append(pedicle.target_in_patient, 1.0))[:3]
        aside = self.truth.carm.centring_error_mm * self._rng.standard_normal(3)
        return Stand(angles, target + aside, self.nominal, self.truth, self.planted)

    def _fitting(self, angles: Angles) -> Pedicle:
        """The pedicle whose planned path is nearest to the beam."""
        beam = angles.beam_in_patient

        def along(pedicle: Pedicle) -> float:
            path = pedicle.entry_in_patient - pedicle.target_in_patient
            return float(beam @ path / np.linalg.norm(path))

        return max(self.patient.pedicles.values(), key=along)

    def _shape(self) -> GuideShape:
        scale = GUIDE_SCALE if RoomFault.GUIDE_SCALED in self.faults else 1.0
        shape = self.planted.shape.scaled(scale)
        return replace(shape, parts=shape.parts - {Part.BEAD}) if RoomFault.NO_BEAD in self.faults else shape

    def _room_from_guide(self, arm: ControllerState) -> Array:
        """Where the guide truly is: true base, true kinematics, true calibration."""
        pose: Array = self._room_from_base(arm) @ arm.base_from_flange_true @ self.planted.flange_from_guide
        return pose

    def _room_from_base(self, arm: ControllerState) -> Array:
        pose = self._cart.room_from_base(arm)
        if RoomFault.BASE_PUSHED in self.faults:
            pose[0, 3] += BASE_PUSH_MM
        return pose

    def _room_from_patient(self, breath_at_s: float | None) -> Array:
        """The patient now, or at the mean breath."""
        shift = np.zeros(3) if breath_at_s is None else breathing_shift(self.truth.patient, breath_at_s)
        if RoomFault.ANATOMY_SHIFT in self.faults:
            shift = shift + np.array([ANATOMY_SHIFT_MM, 0.0, 0.0])
        pose = self.patient.room_from_patient.copy()
        pose[:3, 3] += pose[:3, :3] @ shift
        return pose

    def _target_in_room(self, name: str) -> Array:
        target: Array = (self._room_from_patient(None) @ np.append(self.pedicle(name).target_in_patient, 1.0))[:3]
        return target


def _patient(truth: Truth) -> Patient:
    """The CT that the truth names, or else the procedural spine."""
    return build_patient(truth.seed) if truth.ct is None else patient_of(truth.ct)

"""Random scenes with the ranges of real set-ups: distances, tilts, intensifier and targets."""

from enum import StrEnum

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from simulator.carm.camera import Camera
from simulator.carm.distortion import NO_DISTORTION, draw_distortion
from simulator.carm.guide import GuideShape
from simulator.carm.plate import draw_plate
from simulator.carm.scene import Exposure, PlacedGuide, Scene
from simulator.patient import build_patient

Array = NDArray[np.float64]


class Group(StrEnum):
    """Intensifier; steep view; flat panel; strong distortion with a guide as it comes from manufacture."""

    INTENSIFIER = "ii"
    STEEP = "steep"
    FLAT = "flat"
    STRONG = "strong"


PIXEL_MM = 360.0 / 1024.0
_TILT_DEG = {
    Group.INTENSIFIER: (0.0, 25.0),
    Group.STEEP: (25.0, 35.0),
    Group.FLAT: (0.0, 25.0),
    Group.STRONG: (0.0, 25.0),
}
_MADE_SD_MM = 0.02
_FROM_ABOVE = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 1.0, 0.0]])  # source_from_patient, detector behind


def random_scene(seed: int, group: str = "ii", patient_seed: int | None = None) -> Scene:
    """A scene of one of the groups of the sample images; the same seeds give the same scene."""
    rng, kind = np.random.default_rng(seed), Group(group)
    camera = _camera(rng)
    flat = kind is Group.FLAT
    return Scene(
        camera=camera,
        guides=(PlacedGuide(_shape(rng, kind), _guide_pose(rng, camera, kind)),),
        target_ideal_px=(511.5 + rng.uniform(-150.0, 150.0), 511.5 + rng.uniform(-150.0, 150.0)),
        distortion=NO_DISTORTION if flat else draw_distortion(rng, 1.35 if kind is Group.STRONG else 1.0),
        plate=None if flat else draw_plate(rng),
        intensifier=not flat,
        body=build_patient(seed if patient_seed is None else patient_seed).body,
        source_from_patient=_patient_pose(rng),
        exposure=_exposure(rng),
        name=f"{kind}-{seed}",
        group=kind,
    )


def _camera(rng: np.random.Generator) -> Camera:
    return Camera(
        source_to_image_mm=rng.uniform(965.0, 1040.0),
        pixel_mm=PIXEL_MM,
        principal_u_px=511.5 + rng.uniform(-12.0, 12.0),
        principal_v_px=511.5 + rng.uniform(-12.0, 12.0),
    )


def _shape(rng: np.random.Generator, kind: Group) -> GuideShape:
    if kind is not Group.STRONG:
        return GuideShape()
    small, big, apart = (float(error) for error in rng.normal(0.0, _MADE_SD_MM, 3))
    return GuideShape(small_radius_mm=20.0 + small, big_radius_mm=30.0 + big, separation_mm=60.0 + apart)


def _guide_pose(rng: np.random.Generator, camera: Camera, kind: Group) -> Array:
    """About 25 cm below the intensifier, near the middle, turned anyhow about its own axis."""
    tilt, toward = np.deg2rad(rng.uniform(*_TILT_DEG[kind])), rng.uniform(0.0, 2.0 * np.pi)
    lean = Rotation.from_rotvec(tilt * np.array([np.cos(toward), np.sin(toward), 0.0]))
    pose = np.eye(4)
    pose[:3, :3] = (lean * Rotation.from_euler("z", rng.uniform(0.0, 2.0 * np.pi))).as_matrix()
    pose[:3, 3] = (
        rng.uniform(-32.0, 32.0),
        rng.uniform(-32.0, 32.0),
        camera.source_to_image_mm - rng.uniform(225.0, 285.0),
    )
    return pose


def _patient_pose(rng: np.random.Generator) -> Array:
    """Prone under the guide, the image turned anyhow."""
    tilt = Rotation.from_rotvec(np.deg2rad(rng.normal(0.0, 9.0, 3)))
    turn = Rotation.from_euler("z", rng.uniform(0.0, 2.0 * np.pi))
    pose = np.eye(4)
    pose[:3, :3] = turn.as_matrix() @ tilt.as_matrix() @ _FROM_ABOVE
    pose[:3, 3] = (rng.uniform(-45.0, 45.0), rng.uniform(-45.0, 45.0), rng.uniform(570.0, 610.0))
    return pose


def _exposure(rng: np.random.Generator) -> Exposure:
    return Exposure(
        photons=float(np.exp(rng.uniform(np.log(6000.0), np.log(30000.0)))),
        gamma=rng.uniform(0.7, 0.95),
        blur_px=rng.uniform(0.9, 1.3),
        bits=16 if rng.uniform() < 1.0 / 6.0 else 8,
    )

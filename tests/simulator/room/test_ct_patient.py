"""A room whose patient is a CT: planned paths, picture and truth belong together."""

from dataclasses import replace

import numpy as np
import pytest

from simulator.carm.geometry import angles_of
from simulator.ct.patient import patient_of
from simulator.ct.plan import PlannedCt
from simulator.ct.volume import CtVolume
from simulator.pedicle import Pedicle
from simulator.room import Room
from simulator.truth import read_truth

_CORNER_MM = np.array([310.0, -95.0, -1200.0])
_TARGET_MM = _CORNER_MM + np.array([80.0, 60.0, 70.0])
_NAMES = ("A", "B")


def _volume() -> CtVolume:
    """A trunk of water with a bead of bone at the first target."""
    hounsfield = np.full((100, 80, 90), 0.0, dtype=np.float32)
    hounsfield[:, :8], hounsfield[:, 70:] = -1000.0, -1000.0
    hounsfield[38:43, 28:33, 33:38] = 3000.0
    pose = np.diag([2.0, 2.0, 2.0, 1.0])
    pose[:3, 3] = _CORNER_MM
    return CtVolume(hounsfield, pose)


def _planned(*targets: np.ndarray, step: tuple[float, float, float] = (20.0, 60.0, 5.0)) -> PlannedCt:
    pairs = zip(_NAMES, targets, strict=False)
    return PlannedCt("ct.nii", {name: Pedicle(name, target + np.array(step), target) for name, target in pairs})


@pytest.fixture(autouse=True)
def _no_file(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("simulator.ct.patient.read_ct", lambda _path: _volume())


@pytest.fixture
def room(arm) -> Room:
    planned = _planned(_TARGET_MM, _TARGET_MM + np.array([-30.0, 4.0, 50.0]))
    return Room(arm, replace(read_truth(), ct=planned), now_s=lambda: 0.0)


def test_target_is_seen_where_the_ct_shows_it(room: Room) -> None:
    pedicle = room.pedicle("A")
    room.position(angles_of(pedicle.entry_in_patient, pedicle.target_in_patient), "A")
    scene = room.scene()
    pose = scene.source_from_patient
    target = scene.camera.project(pose[:3, :3] @ pedicle.target_in_patient + pose[:3, 3])
    u, v = np.meshgrid(np.arange(1024.0), np.arange(1024.0))
    near = np.hypot(u - target[0], v - target[1]) < 60.0
    depths = scene.body.depths(scene.camera, pose, np.stack([u, v], axis=-1))
    seen = np.maximum(depths - np.percentile(depths[near], 60), 0.0) * near
    found = [np.sum(seen * u) / np.sum(seen), np.sum(seen * v) / np.sum(seen)]
    np.testing.assert_allclose(found, target, atol=1.5)  # px, 0.3 mm: the water behind is not level


def test_arm_works_where_it_works_on_the_procedural_spine(room: Room) -> None:
    targets = [pedicle.target_in_patient for pedicle in room.patient.pedicles.values()]
    middle = room.patient.room_from_patient @ [*np.mean(targets, axis=0), 1.0]
    np.testing.assert_allclose(middle[:3], [6.4, 0.0, 22.9], atol=1e-9)


def test_exact_guide_has_no_error_in_a_ct_either(room: Room, aligned) -> None:
    aligned("B")
    assert room.errors("B").position_mm < 1e-6


@pytest.mark.parametrize(
    ("planned", "words"),
    [
        (_planned(_TARGET_MM, -_TARGET_MM), "target of B lies outside the CT"),
        (_planned(_TARGET_MM, step=(60.0, 10.0, 0.0)), "A: the C-arm would hit the table"),
    ],
)
def test_plan_that_does_not_fit_the_ct_is_refused(planned: PlannedCt, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        patient_of(planned)

"""The procedural spine: where its pedicles are, and that an X-ray along a planned path shows them."""

import numpy as np
import pytest

from simulator.patient import build_patient

_PATIENT = build_patient(1)


def _bone_depth(origin: np.ndarray, points: np.ndarray) -> np.ndarray:
    rays = points - origin
    rays = (rays / np.linalg.norm(rays, axis=-1, keepdims=True)).astype(np.float32)
    return sum(solid.depths(origin, rays) for solid in _PATIENT.body.bone)


def test_ten_pedicles_are_planned_from_the_back_forwards() -> None:
    assert list(_PATIENT.pedicles)[:2] == ["L1-left", "L1-right"]
    assert len(_PATIENT.pedicles) == 10
    for pedicle in _PATIENT.pedicles.values():
        step = pedicle.entry_in_patient - pedicle.target_in_patient
        assert step[1] > 30.0  # posterior, mm
        assert np.sign(step[0]) == (1.0 if pedicle.name.endswith("left") else -1.0)


@pytest.mark.parametrize("name", ["L2-left", "L3-left", "L3-right", "L4-left", "L4-right"])
def test_beam_along_a_planned_path_shows_the_pedicle_as_a_ring(name: str) -> None:
    pedicle = _PATIENT.pedicles[name]
    along = pedicle.entry_in_patient - pedicle.target_in_patient
    along /= np.linalg.norm(along)
    source = pedicle.target_in_patient - 610.0 * along
    across = np.cross(along, [0.0, 0.0, 1.0])
    across /= np.linalg.norm(across)
    width = {"L2": 4.2, "L3": 4.8, "L4": 5.4}[name[:2]]
    middle, shell = (
        _bone_depth(source, np.array([pedicle.target_in_patient + across * aside])) for aside in (0.0, width - 0.5)
    )
    assert shell[0] > middle[0] + 0.3


def test_another_seed_moves_the_bowel_and_not_the_bone() -> None:
    other = build_patient(2)
    assert [solid.centre_mm for solid in other.body.bone] == [solid.centre_mm for solid in _PATIENT.body.bone]
    assert [solid.centre_mm for solid in other.body.soft] != [solid.centre_mm for solid in _PATIENT.body.soft]

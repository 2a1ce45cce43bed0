"""From positioner angles to source and detector: signs, image orientation, sag."""

from dataclasses import replace

import numpy as np
import pytest

from simulator.carm.geometry import SOURCE_TO_ISOCENTRE_MM, Angles, angles_of, sag_in_room
from simulator.carm.stand import Stand
from simulator.devices import read_mounting, read_nominal_carm, read_shape
from simulator.frames import ROOM_FROM_PATIENT, inverse
from simulator.planted import plant
from simulator.truth import read_truth


def _stand(primary_deg: float, secondary_deg: float, truth_text: bytes = b"") -> Stand:
    truth, nominal = read_truth(truth_text), read_nominal_carm()
    planted = plant(truth, read_shape(), read_mounting().flange_from_guide, nominal.source_to_image_mm)
    angles = Angles(np.deg2rad(primary_deg), np.deg2rad(secondary_deg))
    return Stand(angles, np.zeros(3), nominal, truth, planted)


@pytest.mark.parametrize(
    ("entry", "target", "primary_deg", "secondary_deg", "dial_deg"),
    [
        ((32.0, 85.0, 12.0), (20.0, 40.0, 4.0), 165.0686, 9.7469, -14.9314),
        ((-30.0, 80.0, 10.0), (-22.0, 40.0, 5.0), -168.6901, 6.9880, 11.3099),
    ],
)
def test_angles_of_a_prone_path(
    entry: tuple, target: tuple, primary_deg: float, secondary_deg: float, dial_deg: float
) -> None:
    angles = angles_of(np.array(entry), np.array(target))
    assert np.rad2deg(angles.primary_rad) == pytest.approx(primary_deg, abs=1e-4)
    assert np.rad2deg(angles.secondary_rad) == pytest.approx(secondary_deg, abs=1e-4)
    assert np.rad2deg(angles.from_vertical_rad[0]) == pytest.approx(dial_deg, abs=1e-4)
    path = np.subtract(entry, target) / np.linalg.norm(np.subtract(entry, target))
    np.testing.assert_allclose(angles.beam_in_patient, path, atol=1e-12)


def test_detector_below_the_patient_is_refused() -> None:
    with pytest.raises(ValueError, match="table"):
        Angles(0.0, 0.0)


def test_image_from_above_shows_the_head_on_top_and_the_left_on_the_right() -> None:
    source_from_patient = inverse(_stand(180.0, 0.0).room_from_source()) @ ROOM_FROM_PATIENT
    left, _, head = source_from_patient[:3, 0], source_from_patient[:3, 1], source_from_patient[:3, 2]
    assert left[0] > 0.99  # u to the right
    assert head[1] < -0.99  # v down


def test_isocentre_is_seen_near_the_middle_at_its_nominal_distance() -> None:
    stand = _stand(166.0, 6.0)
    middle = inverse(stand.room_from_source()) @ [0.0, 0.0, 0.0, 1.0]
    assert abs(middle[2] - SOURCE_TO_ISOCENTRE_MM) < 1.0
    assert np.hypot(*middle[:2]) < 0.5


def test_sag_depends_on_the_angles_and_stays_within_its_size() -> None:
    sags = [sag_in_room(Angles(np.pi + a, b), 0.3) for a in (-0.3, 0.0, 0.3) for b in (-0.2, 0.2)]
    assert len({tuple(np.round(sag, 6)) for sag in sags}) == 6
    assert 0.2 < min(map(np.linalg.norm, sags)) <= max(map(np.linalg.norm, sags)) < 0.32


def test_true_intrinsics_are_off_nominal() -> None:
    camera = _stand(180.0, 0.0).camera()
    assert abs(camera.source_to_image_mm - 1000.0) == pytest.approx(14.0)
    assert np.hypot(camera.principal_u_px - 511.5, camera.principal_v_px - 511.5) == pytest.approx(7.0)


def test_distortion_changes_with_the_dials_and_stays_between() -> None:
    assert _stand(170.0, 3.0).distortion() == _stand(170.0, 3.0).distortion()
    assert _stand(170.0, 3.0).distortion() != _stand(171.0, 3.0).distortion()


def test_hidden_turn_moves_the_beam_and_not_the_dials() -> None:
    stand = _stand(170.0, 3.0)
    turned = replace(stand, turned_rad=np.deg2rad(1.0))
    before, after = stand.room_from_source()[:3, 2], turned.room_from_source()[:3, 2]
    assert np.rad2deg(np.arccos(before @ after)) == pytest.approx(1.0, abs=0.01)
    assert turned.angles == stand.angles

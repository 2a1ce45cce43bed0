"""What moves between the two images of a motion is seen before the insertion: C-arm, base or patient (H03, H34)."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from tests.waiting import until

pytestmark = pytest.mark.timeout(300)


def _verdict(case, trigger: str, code: str) -> dict:
    """An interlock's verdict with the newest event of this trigger."""
    until(lambda: any(event["trigger"] == trigger for event in case.record()), 90.0)
    attempts = [one for one in case.attempts() if one["trigger"].startswith("verification")]
    return next(verdict for verdict in attempts[0]["verdicts"] if verdict["code"] == code)


@pytest.mark.hazard("H03")
def test_a_carm_that_turned_by_one_degree_after_registration_voids_the_view(walk) -> None:
    walk.to("moved")
    approved = [event for event in walk.case.record() if event["trigger"] == "move_approved"]
    told = approved[-1]["data"]["detectable_motion"]
    assert 0.0 < told["rotation_deg"] < 1.0  # what the surgeon was told: such a turn will be seen
    turned = np.eye(4)
    turned[:3, :3] = Rotation.from_euler("y", 1.0, degrees=True).as_matrix()
    middle = np.array([0.0, 0.0, 700.0])  # of the C-arm's orbit
    turned[:3, 3] = middle - turned[:3, :3] @ middle
    walk.case.command("exposure-requested")
    walk.carm.expose(turned @ walk.aimed)
    verdict = _verdict(walk.case, "carm_moved", "motion_agrees")
    assert not verdict["passed"]
    assert verdict["measured"] > verdict["limit"] == pytest.approx(18.548, abs=1e-3)
    status = walk.case.status()
    assert status["state"] == "case_open"
    assert [status["chain"][link] for link in ("view", "registration", "verification")] == [None, None, None]


@pytest.mark.hazard("H34")
def test_a_patient_who_moved_by_one_millimetre_voids_the_image(walk) -> None:
    walk.to("moved")
    walk.carm.patient_mm += [1.0, 0.0, 0.0]
    walk.case.command("exposure-requested")
    walk.carm.expose(walk.aimed)
    verdict = _verdict(walk.case, "patient_moved", "anatomy_across")
    walk.carm.patient_mm -= [1.0, 0.0, 0.0]
    assert verdict["measured"] == pytest.approx(1.0, abs=0.2)
    assert verdict["limit"] == 0.5
    status = walk.case.status()
    assert (status["state"], status["chain"]["image"]) == ("carm_positioned", None)

"""One target through the whole procedure: service, guard, controller and C-arm, over the real protocols."""

import pytest

from coaxial_client import Refused


@pytest.mark.timeout(300)
def test_one_target_from_the_open_case_to_the_sleeve_with_one_correction(walk) -> None:
    case = walk.case
    walk.to("off_target")
    walk.corrected()
    walk.verified()
    assert case.status()["allowed"]["insertion_started"]["allowed"], "the request itself locks the guard"
    walk.inserting()
    with pytest.raises(Refused):
        case.plan("retreat", distance_mm=30.0)
    walk.sleeve_inserted()
    assert case.status()["insertion"] == {
        "id": case.status()["insertion"]["id"], "status": "done", "verified": True, "flagged": False
    }  # fmt: skip
    case.command("sleeve-removed", guide="empty")
    done = case.command("target-done", placed=True)
    assert done["state"] == "registered"
    assert case.status()["targets"] == {"L3 left": "placed", "L3 right": "open"}
    evaluations = [event["data"]["contour"] for event in case.record() if event["trigger"].startswith("verification")]
    assert evaluations[0]["position_error_mm"] > 1.5
    assert evaluations[1]["position_error_mm"] < 0.3

"""The chi-square of two images (H03) is held to the limit of the statistics that measured it, and to no other."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from service.conductor import taking
from service.conductor.image_flow import evaluation_of
from vision.anatomy_shift import AnatomyShift
from vision.motion_agreement import CHI_SQUARE_LIMIT, MotionAgreement, RelativeMotion
from vision.result_json import two_images_to_json
from vision.two_images import TwoImages
from workflow.case import opened
from workflow.inquiry import Inquiry
from workflow.limits import Limits
from workflow.snapshot import unknown_snapshot
from workflow.triggers import Trigger
from workflow.verdicts import Verdict
from workflow.verification_interlocks import MOTION_AGREES

_STILL = RelativeMotion(0.0, 0.0, 0.0)
_MORE = 1.0 + 1e-6


def _evaluated(chi_square: float) -> dict[str, Any]:
    """What image work answers with where the guide moved so."""
    compared = TwoImages(MotionAgreement(chi_square, _STILL, _STILL), AnatomyShift(0.0, 0.0, 0.1, 0.9))
    bounds = {"angle_deg": 0.05, "position_mm": 0.1, "depth_mm": 80.0}
    contour = {"angle_error_deg": 0.0, "position_error_mm": 0.0, "predicted_error_95": bounds}
    return two_images_to_json(compared) | {"contour": contour, "agree": True, "registration": {}}


def _judged(result: dict[str, Any]) -> Verdict:
    prepared = evaluation_of("image", result)
    limits = prepared.among(Limits())
    return MOTION_AGREES.judge(
        Inquiry(opened("case"), Trigger.VERIFICATION_PASSED, prepared.facts, unknown_snapshot(), limits, 0.0)
    )


@pytest.mark.hazard("H03")
def test_a_motion_is_held_to_the_limit_that_the_evaluation_tells() -> None:
    passed, refused = _judged(_evaluated(CHI_SQUARE_LIMIT)), _judged(_evaluated(CHI_SQUARE_LIMIT * _MORE))
    assert (passed.passed, refused.passed) == (True, False)
    assert passed.limit == refused.limit == CHI_SQUARE_LIMIT


@pytest.mark.hazard("H03")
def test_without_a_told_limit_no_motion_passes() -> None:
    prepared = evaluation_of("image", _evaluated(1e-3))
    inquiry = Inquiry(opened("case"), Trigger.VERIFICATION_PASSED, prepared.facts, unknown_snapshot(), Limits(), 0.0)
    assert not MOTION_AGREES.judge(inquiry).passed


@pytest.mark.hazard("H03")
def test_the_conductor_decides_by_the_told_limit_and_the_sites_others(monkeypatch: pytest.MonkeyPatch) -> None:
    seen: list[Limits] = []

    def decide(*question: Any) -> None:
        seen.append(question[4])
        raise InterruptedError

    monkeypatch.setattr(taking, "decide", decide)
    site = Limits(angle_error_rad=0.01)
    rules: Any = SimpleNamespace(limits=site, clock=lambda: 0.0)
    standing: Any = SimpleNamespace(case=None, snapshot=None)
    prepared = evaluation_of("image", _evaluated(1.0))
    with pytest.raises(InterruptedError):
        taking.take(standing, rules, Trigger.VERIFICATION_PASSED, prepared, None, None)
    assert seen == [replace(site, motion_chi_square=CHI_SQUARE_LIMIT)]

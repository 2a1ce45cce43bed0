"""A search through an image in which a candidate goes wrong: refused with a reason, never a failure."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from simulator.carm.drawing import random_scene
from simulator.carm.quick_render import render_quickly
from vision import search, solution
from vision.detection import QUICK
from vision.devices import CArm, Guide
from vision.measuring import Scene, find, measure
from vision.projection import View
from vision.refusal import Refusal, RefusalCode
from vision.registered import Registration
from vision.registration import examine
from vision.ring_likeness import lies_on
from vision.solution import Solution, solve
from vision.view_fit import Places
from vision.xray import XrayImage


@pytest.fixture(scope="module")
def image() -> XrayImage:
    """A flat panel's image of the guide."""
    pixels = render_quickly(random_scene(4, "flat"), 4).pixels
    return XrayImage(pixels.astype(np.float32) / 255.0, 8, "0" * 64)


def test_a_faint_ring_is_looked_for_where_a_clear_one_tells(
    guide: Guide, intensifier: CArm, monkeypatch: pytest.MonkeyPatch
) -> None:
    """By itself the small ring is found four pixels off and fits no other."""
    scene = random_scene(5000, "strong")
    pixels = render_quickly(scene, 5000).pixels
    image = XrayImage(pixels.astype(np.float32) / 255.0, 8, "0" * 64)
    assert isinstance(examine(image, guide, intensifier).result, Registration)
    monkeypatch.setattr(search, "_clear_unpaired", lambda _: [])
    assert isinstance(examine(image, guide, intensifier).result, Refusal)


def test_a_view_that_degenerates_in_the_fit_is_refused(
    image: XrayImage, guide: Guide, flat_panel: CArm, monkeypatch: pytest.MonkeyPatch
) -> None:
    def degenerate(*_: Any) -> None:
        raise np.linalg.LinAlgError("Singular matrix")

    monkeypatch.setattr(search, "solve", degenerate)
    result = examine(image, guide, flat_panel).result
    assert isinstance(result, Refusal)
    assert result.code is RefusalCode.GUIDE_MISMATCH


@pytest.mark.parametrize("translation_mm", [(9e4, 9e4, 750.0), (10.0, -5.0, 1e-3), (10.0, -5.0, -750.0)])
def test_a_view_that_ran_out_of_the_image_has_nothing_to_be_measured(
    translation_mm: tuple[float, float, float],
    image: XrayImage,
    guide: Guide,
    flat_panel: CArm,
    monkeypatch: pytest.MonkeyPatch,
    make_view: Any,
) -> None:
    scenes: list[Scene] = []
    monkeypatch.setattr(search, "solve", lambda first, scene: scenes.append(scene) or solve(first, scene))
    examine(image, guide, flat_panel)
    away = make_view(5.0, translation_mm=translation_mm)
    for measured in (measure(away, guide, scenes[0], 0.1), find(away, guide, scenes[0])):
        assert isinstance(measured, Refusal)
        assert measured.code is RefusalCode.GUIDE_CUT_OFF


def test_a_guide_that_reaches_to_the_source_has_nothing_to_be_measured(
    image: XrayImage, guide: Guide, flat_panel: CArm, monkeypatch: pytest.MonkeyPatch, make_view: Any
) -> None:
    scenes: list[Scene] = []
    monkeypatch.setattr(search, "solve", lambda first, scene: scenes.append(scene) or solve(first, scene))
    examine(image, guide, flat_panel)
    tilt = make_view(5.0).source_from_guide[2, 2]
    wide = make_view(5.0, translation_mm=(10.0, -5.0, guide.separation_mm * tilt + 1e-5), alpha_px=300.0)
    measured = measure(wide, guide, scenes[0], 0.1)
    assert isinstance(measured, Refusal)
    assert measured.code is RefusalCode.GUIDE_CUT_OFF


def test_a_guide_that_passed_is_not_refined_once_more(
    image: XrayImage, guide: Guide, flat_panel: CArm, monkeypatch: pytest.MonkeyPatch
) -> None:
    scenes: list[Scene] = []
    monkeypatch.setattr(search, "solve", lambda first, scene: scenes.append(scene) or solve(first, scene))
    findings = examine(image, guide, flat_panel)
    assert findings.search is not None
    assert findings.corrected is not None
    refined = len(scenes)
    again = search._search(findings.corrected, scenes[0], flat_panel, QUICK, findings.search.passed)
    assert isinstance(again.outcome, Solution)
    assert again.outcome is findings.search.outcome
    assert len(scenes) < 2 * refined


def test_the_same_rings_with_the_line_elsewhere_are_another_view(
    image: XrayImage, guide: Guide, flat_panel: CArm
) -> None:
    findings = examine(image, guide, flat_panel)
    assert findings.search is not None
    assert isinstance(findings.search.outcome, Solution)
    fit = findings.search.outcome.fit
    assert lies_on(fit.view, fit.guide, fit.view, fit.guide)
    turned = fit.view.source_from_guide @ np.diag((-1.0, -1.0, 1.0, 1.0))
    assert not lies_on(replace(fit.view, source_from_guide=turned), fit.guide, fit.view, fit.guide)


def test_a_fit_without_a_finite_step_says_so(
    image: XrayImage, guide: Guide, flat_panel: CArm, monkeypatch: pytest.MonkeyPatch
) -> None:
    design = Places.design

    def nowhere(places: Places, *arguments: Any) -> NDArray[np.float64]:
        return np.full_like(design(places, *arguments), np.nan)

    monkeypatch.setattr(Places, "design", nowhere)
    result = examine(image, guide, flat_panel).result
    assert isinstance(result, Refusal)
    assert result.code is RefusalCode.GUIDE_MISMATCH


def test_wires_are_cut_anew_only_where_the_fit_took_them_too_far(
    image: XrayImage, guide: Guide, flat_panel: CArm, monkeypatch: pytest.MonkeyPatch
) -> None:
    views: list[View] = []
    monkeypatch.setattr(solution, "measure", lambda view, *more: views.append(view) or measure(view, *more))
    centres, counts = [], []
    for linear_px in (10.0, 0.0):
        monkeypatch.setattr(solution, "_LINEAR_PX", linear_px)
        result = examine(image, guide, flat_panel).result
        assert isinstance(result, Registration)
        centres.append(result.fiducials_px["small_centre"])
        counts.append(len(views))
        views.clear()
    assert counts[1] == counts[0] + 1
    assert centres[1] == pytest.approx(centres[0], abs=0.02)


def test_views_of_one_guide_that_differ_in_depth_are_one(image: XrayImage, guide: Guide, flat_panel: CArm) -> None:
    """Source distance and the guide's own trade: by some millimetres they look alike."""
    findings = examine(image, guide, flat_panel)
    assert findings.search is not None
    (passed,) = findings.search.passed
    assert isinstance(passed.outcome, Solution)
    fit = passed.outcome.fit
    pose, seen = fit.view.source_from_guide.copy(), fit.view.intrinsics
    longer = 1.005
    pose[:3, 3] *= (1.0, 1.0, longer)
    farther = View(replace(seen, alpha_x_px=seen.alpha_x_px * longer, alpha_y_px=seen.alpha_y_px * longer), pose)
    again = replace(passed, outcome=replace(passed.outcome, fit=replace(fit, view=farther)))
    assert search._passed([passed, again]) == [passed]
    turned = View(seen, fit.view.source_from_guide @ np.diag((-1.0, -1.0, 1.0, 1.0)))
    elsewhere = replace(passed, outcome=replace(passed.outcome, fit=replace(fit, view=turned)))
    assert search._passed([passed, elsewhere]) == [passed, elsewhere]

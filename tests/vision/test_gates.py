"""Each gate just inside and just outside its limit."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from vision import gates
from vision.contour import ContourFit
from vision.devices import Guide
from vision.distortion import DistortionMap
from vision.line_ends import LineEnd
from vision.projection import Intrinsics, View, project
from vision.refusal import Refusal, RefusalCode
from vision.registered import DEFAULT_DEPTH_MM, PredictedError
from vision.strain import Strain
from vision.view_fit import Observations
from vision.wire_model import Wire, WireSamples

PULLS = ("source_to_image", "square", "centre_u", "centre_v", "small_radius", "big_radius", "separation")
LIMIT_JUST_ABOVE, LIMIT_JUST_BELOW = 1.001, 0.999


@pytest.fixture
def fit(guide: Guide) -> ContourFit:
    """A faultless fit of 72 points a ring and 40 on the line."""
    pose = np.eye(4)
    pose[2, 3] = 750.0
    return ContourFit(
        view=View(Intrinsics(2844.0, 2844.0, 511.5, 511.5), pose),
        guide=guide,
        residual_px=np.zeros(184),
        weight=np.ones(184),
        noise_px=0.1,
        pulls_sd=dict.fromkeys(PULLS, 0.0),
        strain=Strain(PULLS, np.zeros(7), 0.0, 7, np.zeros((7, 13))),
        covariance=np.eye(13),
        map=DistortionMap.identity(1024, 1024, 0.35),
    )


def places() -> WireSamples:
    """A place in each sector of 5 degrees of both rings, and 40 along the line."""
    angles = (np.arange(72) + 0.5) * 2.0 * math.pi / 72.0
    wire = np.repeat([Wire.SMALL_RING, Wire.BIG_RING, Wire.LINE], [72, 72, 40]).astype(np.intp)
    along = np.concatenate((angles, angles, np.linspace(26.0, 66.0, 40)))
    return WireSamples(wire, along, np.zeros((184, 2)), np.zeros((184, 2)))


def observations(seen: NDArray[np.bool_]) -> Observations:
    """Those places that were seen."""
    at = places().chosen(seen)
    none = np.zeros((0, 3)), np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0)
    return Observations(at.wire, at.along, at.points, at.normals, np.zeros(len(at.along)), *none)


def coverage(fit: ContourFit, hidden: slice, covered: slice | None = None) -> Refusal | None:
    """The gate's word when some places show nothing and a crossing covers others."""
    seen, possible = np.ones(184, dtype=bool), np.ones(184, dtype=bool)
    seen[hidden] = False
    if covered is not None:
        seen[covered] = possible[covered] = False
    fewer = replace(fit, weight=np.ones(int(seen.sum())), residual_px=np.zeros(int(seen.sum())))
    return gates.check_coverage(fewer, observations(seen), places().chosen(possible))


@pytest.mark.hazard("H07")
def test_a_hundred_degrees_of_a_ring_may_be_hidden_and_no_more(fit: ContourFit) -> None:
    assert coverage(fit, slice(30, 50)) is None
    refusal = coverage(fit, slice(30, 51))
    assert refusal is not None
    assert refusal.code is RefusalCode.RING_MISSING
    assert refusal.measured == pytest.approx(105.0)


def test_a_gap_is_counted_across_the_angle_where_counting_begins(fit: ContourFit) -> None:
    seen = np.ones(184, dtype=bool)
    seen[72:83] = seen[133:144] = False
    fewer = replace(fit, weight=np.ones(int(seen.sum())))
    refusal = gates.check_coverage(fewer, observations(seen), places())
    assert refusal is not None
    assert refusal.measured == pytest.approx(110.0)


def test_what_a_crossing_covers_is_no_gap_but_half_a_ring_must_be_seen(fit: ContourFit) -> None:
    assert coverage(fit, slice(0, 0), covered=slice(10, 45)) is None
    refusal = coverage(fit, slice(0, 0), covered=slice(10, 47))
    assert refusal is not None
    assert refusal.code is RefusalCode.RING_MISSING


def test_points_without_weight_are_not_seen(fit: ContourFit) -> None:
    weight = np.ones(184)
    weight[72:110] = 0.0
    assert (
        gates.check_coverage(replace(fit, weight=weight), observations(np.ones(184, dtype=bool)), places()) is not None
    )


END = LineEnd(66.0, 0.0, 0.5, 0.3)


def line(fit: ContourFit, count: int, ends: list[LineEnd]) -> Refusal | None:
    """The gate's word when so many of the line's 40 places are seen."""
    seen = np.ones(184, dtype=bool)
    seen[144 + count :] = False
    fewer = replace(fit, weight=np.ones(int(seen.sum())))
    return gates.check_line(fewer, observations(seen), places(), ends)


def test_the_line_must_be_seen_with_an_end_of_it(fit: ContourFit) -> None:
    assert line(fit, 16, [END]) is None
    for count, ends in ((15, [END]), (40, [])):
        refusal = line(fit, count, ends)
        assert refusal is not None
        assert refusal.code is RefusalCode.LINE_MISSING


@pytest.mark.hazard("H07")
@pytest.mark.parametrize("wire", [slice(0, 72), slice(72, 144)], ids=["small", "big"])
def test_what_a_ring_leaves_must_be_noise_and_structure(fit: ContourFit, wire: slice) -> None:
    everywhere = replace(observations(np.ones(184, dtype=bool)), sd_px=np.full(184, 0.12))
    left = np.zeros(184)
    for left_px, passes in ((0.38, True), (0.40, False)):  # three times 0.13 px
        left[wire] = left_px
        refusal = gates.check_explained(replace(fit, residual_px=left, weight=np.ones(184)), everywhere)
        assert (refusal is None) is passes
        assert refusal is None or refusal.code is RefusalCode.RESIDUAL_TOO_HIGH


def test_line_ends_in_place_pass_others_do_not() -> None:
    near, off, faint = replace(END, excess_px=-1.16), replace(END, excess_px=1.18), replace(END, amplitude=0.1)
    assert gates.check_line_ends([near, END], 0.2) is None
    assert gates.check_line_ends([], 0.2) is None
    assert gates.check_line_ends([replace(off, sd_px=0.5)], 0.2) is None
    mismatch, missing = gates.check_line_ends([END, off], 0.2), gates.check_line_ends([END, faint], 0.2)
    assert mismatch is not None
    assert mismatch.code is RefusalCode.GUIDE_MISMATCH
    assert missing is not None
    assert missing.code is RefusalCode.LINE_MISSING


def strained(fit: ContourFit, **changes: Any) -> ContourFit:
    """The fit with other tests of its priors."""
    return replace(fit, strain=replace(fit.strain, **changes))


@pytest.mark.parametrize("prior", range(7))
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_strained_prior_is_named(fit: ContourFit, prior: int, sign: float) -> None:
    inside, outside = (
        gates.check_pulls(strained(fit, deviations=np.eye(7)[prior] * sign * gates.GREATEST_PULL_SD * factor))
        for factor in (LIMIT_JUST_BELOW, LIMIT_JUST_ABOVE)
    )
    assert inside is None
    assert outside is not None
    assert outside.code is RefusalCode.GUIDE_MISMATCH
    assert PULLS[prior] in outside.message


def test_limits_are_those_of_one_false_refusal_in_ten_thousand() -> None:
    limits = (gates.GREATEST_PULL_SD, gates.GREATEST_BEAD_SD)
    np.testing.assert_allclose(limits, (3.891, 4.292), atol=1e-3)  # tables of the normal and of chi-square


@pytest.mark.parametrize(("joint", "freedom", "passes"), [(29.8, 7, True), (30.0, 7, False), (24.0, 4, False)])
def test_all_pulls_are_judged_together(fit: ContourFit, joint: float, freedom: int, passes: bool) -> None:
    refusal = gates.check_pulls(strained(fit, joint=joint, freedom=freedom))
    assert (refusal is None) is passes
    assert refusal is None or refusal.code is RefusalCode.GUIDE_MISMATCH


def test_pulls_that_are_no_numbers_are_refused(fit: ContourFit) -> None:
    assert gates.check_pulls(strained(fit, deviations=np.full(7, np.nan))) is not None
    assert gates.check_pulls(strained(fit, joint=math.nan)) is not None


def test_a_registration_that_hangs_on_one_dimension_is_refused(fit: ContourFit, guide: Guide) -> None:
    """A turn about the source's x axis by as much turns the aim; a turn of 0.4 deg moves it 0.98 mm at the target."""
    turn, steps = np.radians(0.4), np.zeros((7, 13))
    for factor, passes in ((0.9, True), (1.3, False)):
        steps[6, 4] = turn * factor
        refusal = gates.check_trust(strained(fit, freed_steps=steps), guide)
        assert (refusal is None) is passes
        assert refusal is None or "separation" in refusal.message


def test_an_aim_is_judged_where_targets_are_not_only_under_the_guide(fit: ContourFit, guide: Guide) -> None:
    """A longer source distance with the guide as much farther changes the aim to the side alone."""
    steps = np.zeros((7, 13))
    steps[0, [0, 1, 9]] = 0.4 * np.array([2844.0, 2844.0, 750.0])
    refusal = gates.check_trust(strained(fit, freed_steps=steps), guide)
    assert refusal is not None
    assert "source_to_image" in refusal.message
    strain, view = strained(fit, freed_steps=steps / 2.0).strain, fit.view
    beside, under = (project(view, np.array([[x_mm, 0.0, 0.0]]))[0] for x_mm in (40.0, 0.0))
    assert gates.check_trust_at(view, strain, guide, under, DEFAULT_DEPTH_MM) is None
    assert gates.check_trust_at(view, strain, guide, beside, DEFAULT_DEPTH_MM) is not None


@pytest.mark.parametrize(("distance_sd", "passes"), [(4.2, True), (4.4, False), (math.nan, False)])
def test_bead_is_held_to_its_place(distance_sd: float, passes: bool) -> None:
    refusal = gates.check_bead(distance_sd)
    assert (refusal is None) is passes
    assert refusal is None or refusal.code is RefusalCode.GUIDE_MISMATCH


@pytest.mark.parametrize(("tilt_deg", "passes"), [(0.0, True), (44.9, True), (45.1, False), (179.0, False)])
def test_the_tilt_is_limited(fit: ContourFit, tilt_deg: float, passes: bool) -> None:
    pose = fit.view.source_from_guide.copy()
    c, s = math.cos(math.radians(tilt_deg)), math.sin(math.radians(tilt_deg))
    pose[:3, :3] = [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
    refusal = gates.check_tilt(View(fit.view.intrinsics, pose))
    assert (refusal is None) is passes


@pytest.mark.hazard("H07")
def test_residual_scale_and_predicted_errors_are_limited(fit: ContourFit) -> None:
    assert gates.check_residual(fit) is None
    noisy = gates.check_residual(replace(fit, noise_px=gates.GREATEST_RESIDUAL_PX * LIMIT_JUST_ABOVE))
    assert noisy is not None
    assert noisy.code is RefusalCode.RESIDUAL_TOO_HIGH
    assert gates.check_scale(0.3516, 0.3516 * 1.05) is None
    for file_mm in (0.3516 * 2.0, 0.3516 / 2.0):
        scale = gates.check_scale(0.3516, file_mm)
        assert scale is not None
        assert scale.code is RefusalCode.SCALE_MISMATCH
    assert gates.check_predicted(PredictedError(1e-3, 0.1, 80.0)) is None
    for angle_rad, position_mm in ((0.01, 0.1), (1e-3, 0.6), (math.nan, 0.1), (1e-3, math.nan)):
        predicted = gates.check_predicted(PredictedError(angle_rad, position_mm, 80.0))
        assert predicted is not None
        assert predicted.code is RefusalCode.PREDICTED_ERROR_TOO_HIGH


def test_an_aim_may_be_as_unsure_as_a_wrong_one_and_no_more() -> None:
    angle_rad, position_mm = gates.WRONG_RAD, gates.WRONG_MM
    just_right = PredictedError(angle_rad * LIMIT_JUST_BELOW, position_mm * LIMIT_JUST_BELOW, 80.0)
    assert gates.check_aim(just_right) is None
    for changes in (
        {"angle_rad": angle_rad * LIMIT_JUST_ABOVE},
        {"position_mm": position_mm * LIMIT_JUST_ABOVE},
        {"angle_rad": math.nan},
    ):
        refusal = gates.check_aim(replace(just_right, **changes))
        assert refusal is not None
        assert refusal.code is RefusalCode.PREDICTED_ERROR_TOO_HIGH


@pytest.mark.hazard("H06")
@pytest.mark.parametrize(("told_mm", "passes"), [(0.3516, True), (0.3549, True), (0.3553, False), (0.0, False)])
def test_a_panel_s_pixel_size_is_held_to_what_the_header_tells(told_mm: float, passes: bool) -> None:
    refusal = gates.check_told_scale(told_mm, 0.3516, gates.GREATEST_TOLD_SCALE_OFF)
    assert (refusal is None) is passes
    assert refusal is None or refusal.code is RefusalCode.SCALE_MISMATCH


def test_a_scale_that_is_no_number_is_refused() -> None:
    refusal = gates.check_scale(math.nan, 0.35)
    assert refusal is not None
    assert refusal.code is RefusalCode.SCALE_MISMATCH


def test_a_tilt_that_is_no_number_is_refused(vector_view: View) -> None:
    refusal = gates.check_tilt(View(vector_view.intrinsics, np.full((4, 4), math.nan)))
    assert refusal is not None
    assert refusal.code is RefusalCode.GUIDE_MISMATCH

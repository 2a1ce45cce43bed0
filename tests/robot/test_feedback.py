"""Feedback, rest and displacement, reading by reading (H21, H04)."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from robot.arm import ArmState
from robot.guard.feedback import STALE_S, FeedbackWatch, Verdict
from robot.guard.rest import DisplacementWatch, RestWatch

At = Callable[..., ArmState]


def test_advancing_readings_are_good_and_go_stale(at: At) -> None:
    watch = FeedbackWatch()
    assert [watch.take(at(0.008 * index)) for index in range(5)] == [Verdict.GOOD] * 5
    assert watch.is_fresh(0.032 + STALE_S)
    assert not watch.is_fresh(0.032 + STALE_S + 1e-6)


@pytest.mark.hazard("H21")
def test_readings_that_come_later_and_later_go_stale_however_steadily_they_come(at: At) -> None:
    watch = FeedbackWatch()
    for index in range(8):  # each 16 ms later than its time, beyond the first
        watch.take(replace(at(0.008 * index), received_at_s=50.0 + 0.024 * index))
    assert watch.late_s == pytest.approx(0.112, abs=1e-3)
    assert not watch.is_fresh(50.0 + 0.024 * 7)
    watch.forget()
    watch.take(replace(at(0.064), received_at_s=60.0))
    assert watch.is_fresh(60.0)


def test_a_reading_that_is_late_alone_leaves_the_next_one_fresh(at: At) -> None:
    watch = FeedbackWatch()
    watch.take(at(0.0))
    watch.take(replace(at(0.008), received_at_s=0.09))
    assert watch.late_s == pytest.approx(0.082, abs=1e-3)
    assert not watch.is_fresh(0.12)
    watch.take(replace(at(0.088), received_at_s=0.091))
    assert watch.is_fresh(0.12)


@pytest.mark.parametrize("rate", [-6e-4, 6e-4])  # a slewed clock and two crystals
def test_two_clocks_that_differ_make_no_reading_late(at: At, rate: float) -> None:
    watch = FeedbackWatch()
    for second in range(0, 36000, 10):  # ten hours
        watch.take(replace(at(float(second)), received_at_s=second * (1.0 + rate)))
        assert watch.is_fresh(second * (1.0 + rate) + 0.09)


@pytest.mark.hazard("H21")
@pytest.mark.parametrize("field", ["joints_rad", "joint_speeds_rad_s", "base_from_tcp", "payload_centre_mm"])
@pytest.mark.parametrize("value", [np.nan, np.inf, -1e200])  # the last one's square is none
def test_reading_with_a_number_that_is_none_is_not_kept(at: At, field: str, value: float) -> None:
    watch = FeedbackWatch()
    watch.take(at(0.0))
    broken = np.array(getattr(at(0.008), field))
    broken.flat[0] = value
    assert watch.take(replace(at(0.008), **{field: broken})) is Verdict.NOT_FINITE
    assert watch.newest is not None
    assert watch.newest.controller_time_s == 0.0


@pytest.mark.hazard("H21")
@pytest.mark.parametrize("time_s", [0.0, -0.008])
def test_controller_time_that_stands_or_goes_back_is_out_of_order(at: At, time_s: float) -> None:
    watch = FeedbackWatch()
    watch.take(at(0.0))
    assert watch.take(at(time_s)) is Verdict.OUT_OF_ORDER


@pytest.mark.hazard("H21")
@pytest.mark.parametrize("speed_mm_s", [18.0, 0.7])  # no speed lies between frozen and at rest
def test_pose_that_stands_while_a_speed_is_claimed_is_frozen(at: At, speed_mm_s: float) -> None:
    watch = FeedbackWatch()
    verdicts = [watch.take(at(0.008 * index, x_mm=3.0, speed_mm_s=speed_mm_s)) for index in range(20)]
    assert verdicts[:12] == [Verdict.GOOD] * 12
    assert verdicts[14:] == [Verdict.FROZEN] * 6  # from 0.1 s on


def test_arm_at_rest_without_a_changing_bit_is_not_frozen(at: At) -> None:
    watch = FeedbackWatch()
    assert {watch.take(at(0.008 * index)) for index in range(200)} == {Verdict.GOOD}


def test_controller_that_counts_from_zero_again_is_heard_after_a_reconnection(at: At) -> None:
    watch = FeedbackWatch()
    watch.take(at(1000.0))
    watch.forget()
    assert watch.take(at(0.0)) is Verdict.GOOD


def test_rest_is_counted_from_the_end_of_the_motion(at: At) -> None:
    watch = RestWatch()
    assert watch.observe(at(0.0, speed_mm_s=5.0)) == 0.0
    assert watch.observe(at(0.1)) == 0.0
    assert watch.observe(at(0.4)) == pytest.approx(0.3)


def test_creep_below_the_speed_of_noise_is_no_rest(at: At) -> None:
    watch = RestWatch()
    rests = [watch.observe(at(0.1 * index, x_mm=0.04 * index, speed_mm_s=0.4)) for index in range(20)]
    assert max(rests) < 0.15  # s: 0.04 mm in each 0.1 s passes the 0.03 mm of one rest


def told_by(watch: DisplacementWatch, readings: list[ArmState]) -> list[float]:
    told = [watch.observe(reading) for reading in readings]
    return [disturbed.offset_mm for disturbed in told if disturbed is not None]


@pytest.mark.hazard("H04")
@pytest.mark.parametrize(("step_mm", "told_mm"), [(0.04, []), (0.06, [0.06]), (-0.06, [0.06])])
def test_displacement_is_told_once_above_its_limit(at: At, step_mm: float, told_mm: list[float]) -> None:
    watch = DisplacementWatch()
    watch.observe(at(0.0))
    assert told_by(watch, [at(0.1 * index, x_mm=step_mm) for index in range(1, 20)]) == pytest.approx(told_mm)


@pytest.mark.hazard("H04")
def test_push_that_takes_its_time_is_told_whole(at: At) -> None:
    watch = DisplacementWatch()
    ramp = [at(0.008 * index, x_mm=min(0.01 * index, 0.12)) for index in range(100)]
    assert told_by(watch, ramp) == pytest.approx([0.12])


def test_blow_that_springs_back_is_told_with_its_peak(at: At) -> None:
    watch = DisplacementWatch()
    blow = [at(0.01 * index, x_mm=0.3 if index == 5 else 0.0) for index in range(50)]
    assert told_by(watch, blow) == pytest.approx([0.3])


@pytest.mark.hazard("H04")
def test_creep_by_many_small_steps_is_told(at: At) -> None:
    watch = DisplacementWatch()
    assert len(told_by(watch, [at(0.1 * index, x_mm=0.01 * index) for index in range(9)])) == 1


def test_jogged_arm_is_told_ten_times_a_second_and_none_of_it_is_lost(at: At) -> None:
    watch = DisplacementWatch()
    offsets = told_by(watch, [at(0.01 * index, x_mm=0.1 * index) for index in range(301)])
    assert 20 <= len(offsets) <= 30  # in 3 s
    assert sum(offsets) == pytest.approx(30.0, abs=1.2)  # mm; what is still being gathered is told with the next


def test_accounted_motion_disturbs_nothing(at: At) -> None:
    watch = DisplacementWatch()
    watch.observe(at(0.0))
    watch.account(at(1.0, x_mm=10.0))
    assert told_by(watch, [at(1.1 + 0.1 * index, x_mm=10.0) for index in range(5)]) == []
    assert told_by(watch, [at(2.0 + 0.1 * index) for index in range(5)]) == pytest.approx([10.0])

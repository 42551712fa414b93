"""Times of the frames of a file from time stamps of any kind."""

import math
from collections.abc import Sequence
from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from matchset.media.video_files.file_clock import DEFAULT, FileClock, stamp_rate

NONE = math.nan


def times(stamps: Sequence[float], stated: float = 25.0, given: float | None = None) -> tuple[list[float], FileClock]:
    clock = FileClock(stamps[:16], stated, given)
    return [clock.time(index, stamp) for index, stamp in enumerate(stamps)], clock


def even(count: int, period: float = 0.04) -> list[float]:
    return [index * period for index in range(count)]


def test_good_stamps_are_the_times() -> None:
    stamps = [0.0, 0.33, 0.37, 0.45, 0.9, 2.0]
    assert times(stamps)[0] == stamps
    assert times(stamps)[1].warnings == []


@pytest.mark.parametrize("rate", [30.0, 50.0, 60.0])
def test_equal_stamps_of_a_coarse_grid_cost_less_than_a_tick(rate: float) -> None:
    true = even(300, 1.0 / rate)
    found, clock = times([round(24.0 * time) / 24.0 for time in true], rate)
    assert max(abs(time - right) for time, right in zip(found, true, strict=True)) < 1.0 / 24.0
    assert len(clock.warnings) == 1
    assert "no usable time stamp, their times are interpolated" in clock.warnings[0]


def test_one_equal_stamp_costs_half_a_period_and_no_other_frame_anything() -> None:
    stamps = even(60)
    stamps[40] = stamps[39]
    found, clock = times(stamps)
    assert found[40] == pytest.approx(39.5 * 0.04)
    assert found[:40] + found[41:] == stamps[:40] + stamps[41:]
    assert clock.warnings == ["frame 40 has no usable time stamp, its time is interpolated"]


@pytest.mark.parametrize("missing", [0.0, NONE, -1e9])
def test_a_missing_stamp_follows_at_the_usual_period(missing: float) -> None:
    found, _ = times([*even(60), missing, missing])
    assert found == pytest.approx(even(62))


def test_frames_that_did_not_decode_have_their_time() -> None:
    clock = FileClock(even(16), 25.0, None)
    assert clock.time(0, 0.0) == 0.0
    assert clock.time(5, NONE) == pytest.approx(0.2)
    assert clock.time(8, 0.32) == 0.32
    assert clock.period == pytest.approx(0.04)


def test_stamps_that_begin_anew_are_followed() -> None:
    second = [10.0, 10.1, 10.2, 10.3]
    found, clock = times([*even(80), *(time - 10.0 for time in second), 0.5, 0.9])
    assert found[:80] == even(80)
    assert [late - early for early, late in pairwise(found[-3:])] == pytest.approx([0.2, 0.4])
    assert "begin anew near frame 83" in clock.warnings[0]


def test_one_stamp_far_ahead_does_not_stop_the_clock() -> None:
    stamps = even(60)
    stamps[30] = 5000.0
    found, _ = times(stamps)
    assert found[:30] == stamps[:30]
    assert [late - early for early, late in pairwise(found[31:])] == pytest.approx([0.04] * 28)


def test_time_begins_near_0_where_the_stamps_do_not() -> None:
    stamps = [-4e9 + 0.125 * index for index in range(40)]
    found, clock = times(stamps, 8.0)
    assert found == even(40, 0.125)
    assert clock.warnings == []
    assert times([95000.0, 95000.5])[0] == [95000.0, 95000.5]


def test_stamps_out_of_order_give_only_the_rate() -> None:
    found, clock = times([0.0, 0.3, 0.1, 0.2, 0.4, 0.7, 0.5, 0.6], 600.0)
    assert found == pytest.approx(even(8, 0.1))
    assert clock.warnings == [
        "the file's time stamps are out of order, and its frame rate, 600, is not credible: 10 frames/s are assumed; "
        "if that is wrong, give the rate with --fps (in Python: fps)"
    ]


@pytest.mark.parametrize(("stated", "rate"), [(25.0, 25.0), (0.0, 30.0), (90000.0, 30.0), (NONE, 30.0)])
def test_without_stamps_the_rate_is_said_at_once(stated: float, rate: float) -> None:
    clock = FileClock([0.0] * 16, stated, None)
    assert f"{rate:g} frames/s are assumed" in clock.warnings[0]
    assert "--fps" in clock.warnings[0]
    assert [clock.time(index, 0.0) for index in range(3)] == pytest.approx(even(3, 1.0 / rate))


@pytest.mark.parametrize(("stated", "rate"), [(600.0, 25.0), (1e6, 25.0), (0.0, 25.0), (30.0, 30.0)])
def test_a_rate_that_the_stamps_contradict_is_not_used(stated: float, rate: float) -> None:
    found, clock = times(even(20), stated)
    assert found == even(20)
    assert clock.rate == pytest.approx(rate)
    assert clock.warnings == []


def test_an_unusual_rate_is_believed_and_said() -> None:
    found, clock = times(even(20, 1.0 / 600.0), 600.0)
    assert found == even(20, 1.0 / 600.0)
    assert clock.warnings[0].startswith("the file's time stamps say 600 frames/s; if that is wrong")


def test_a_given_rate_is_all_that_counts() -> None:
    found, clock = times([0.0, 0.0, 7.0, 3.0], 600.0, given=50.0)
    assert found == even(4, 0.02)
    assert (clock.rate, clock.warnings) == (50.0, [])


def test_one_frame_needs_no_rate() -> None:
    assert times([0.0], 0.0)[1].warnings == []


@given(st.lists(st.floats(-1e6, 1e6) | st.sampled_from([NONE, math.inf, 0.0, 1.0, 1.0, 2.0]), max_size=60))
def test_time_runs_forward_whatever_the_stamps(stamps: list[float]) -> None:
    found, _ = times(stamps)
    assert all(early < late for early, late in pairwise(found))
    assert all(map(math.isfinite, found))


def test_the_rate_of_stamps_is_robust() -> None:
    assert stamp_rate([]) is None
    assert stamp_rate([3.0]) is None
    assert stamp_rate([3.0] * 16) is None
    assert stamp_rate([*even(14), 1e6, -1e6]) == pytest.approx(25.0)
    assert DEFAULT.memory >= DEFAULT.equal_frames

import copy
import math

import msgspec
import numpy as np
import pytest

from matchset.control.chain.next_but_one import NextButOne, NextButOneParameters, mix
from matchset.control.ego_motion import EgoMotion
from matchset.control.neighbor_filter import NeighborFilter
from matchset.localization.pose import Pose

STEP, DELAY = 1.0 / 30.0, 0.097
NOBODY_MOVES = EgoMotion()


def pose(x: float, y: float, z: float, time: float, turn: float | None = None) -> Pose:
    """A ball at rest, its marker turned from facing us by an angle to its right; None: not seen."""
    c, s = math.cos(turn or 0.0), math.sin(turn or 0.0)
    back = np.array(((-c, 0.0, -s), (0.0, 1.0, 0.0), (s, 0.0, -c)))
    return Pose(
        position=np.array((x, y, z)),
        rotation_matrix=None if turn is None else back,
        covariance=1e-6 * np.eye(6),
        observed="position" if turn is None else "level",
        time=time,
    )


def flown(beyond: NextButOne, seconds: float = 2.0, turn: float = 0.0, hidden: float = math.inf) -> NeighborFilter:
    """Watch the neighbor at 1.5 m, and the next ball, 0.2 m too near to it and 0.1 m to the side and higher."""
    neighbor = NeighborFilter()
    for k in range(round(seconds / STEP)):
        now = k * STEP
        own = NOBODY_MOVES.at(now)
        neighbor.update(pose(0.0, -0.2, 1.5, now, turn), own)
        if now < hidden:
            beyond.update(pose(0.1, -0.3, 1.5 + 1.35, now), own)
        beyond.at_times(neighbor, (now + 0.1,), 0.4)
    return neighbor


def swung(beyond: NextButOne, period: float, amplitude: float = 0.1, seconds: float = 12.0) -> tuple[float, float]:
    """Watch both balls, the next but one alone swinging to the side; how far what is controlled swings, m, and when."""
    neighbor, seen = NeighborFilter(), []
    for k in range(round(seconds / STEP)):
        now = k * STEP
        own = NOBODY_MOVES.at(now)
        neighbor.update(pose(0.0, -0.2, 1.5, now, 0.0), own)
        x = amplitude * math.sin(2.0 * math.pi * now / period)
        beyond.update(pose(x, -0.2, 3.05, now), own)
        seen.append((now, beyond.at_times(neighbor, (now + DELAY,), 0.4)[0].x.value))
    time, moved = np.array(seen[len(seen) // 2 :]).T
    wave = np.exp(-2j * math.pi * (time + DELAY) / period)
    answer = 2.0 * (moved * wave).mean() * 1j
    return abs(answer), float(np.angle(answer))


def test_a_share_of_the_fast_motion_of_the_next_but_one_ball_is_followed() -> None:
    moved, _ = swung(NextButOne(NextButOneParameters(share=0.5, time_constant=4.0, max_time_constant=4.0)), period=2.2)
    assert moved == pytest.approx(0.05, rel=0.15)  # 0.5 of 10 cm, at the period that the filter expects


def test_more_of_it_is_followed_where_the_delay_is_longer() -> None:
    told = NextButOneParameters(share=1.0, time_constant=0.3, max_time_constant=3.0)
    quick, late = (
        swung(NextButOne(msgspec.structs.replace(told, reference_delay=delay)), 2.2)[0] for delay in (DELAY, DELAY / 2)
    )
    assert late > 2.0 * quick


def test_where_that_would_be_slower_than_is_useful_less_of_it_is_followed() -> None:
    told = NextButOneParameters(share=1.0, time_constant=0.5, delay_exponent=1.0)
    whole, half = (
        swung(NextButOne(msgspec.structs.replace(told, max_time_constant=0.5, reference_delay=delay)), 2.2)[0]
        for delay in (DELAY, DELAY / 2)
    )
    assert half == pytest.approx(0.5 * whole, rel=0.1)


def test_what_is_slow_counts_for_nothing() -> None:
    for period, most in ((16.0, 0.02), (6.0, 0.15)):
        moved, _ = swung(NextButOne(NextButOneParameters(share=1.0, time_constant=0.3)), period, seconds=4.0 * period)
        assert moved < most * 0.1
    beyond = NextButOne(NextButOneParameters(share=1.0))
    neighbor = flown(beyond)  # not at its place, but at rest
    there, here = beyond.at_times(neighbor, (2.1,), 0.4)[0], neighbor.at_times((2.1,), 0.4)[0]
    assert np.abs(there.place - here.place).max() < 0.003
    assert there.yaw == here.yaw


def test_a_ball_that_nobody_follows_is_expected_where_the_neighbor_would_be_right() -> None:
    beyond, own = NextButOne(NextButOneParameters(share=1.0, height_difference=0.05)), NOBODY_MOVES.at(2.0)
    neighbor = flown(beyond, turn=0.3, hidden=0.0)
    yaw = neighbor.at_times((2.0,), 0.4)[0].yaw.value
    should = (-1.55 * math.sin(yaw), -0.15, 1.5 - 1.55 * math.cos(yaw))
    assert beyond.expected(neighbor, own, 2.0, 0.4) == pytest.approx(should, abs=0.01)
    assert not beyond.is_followed(2.0)


def test_a_ball_that_is_followed_is_expected_where_it_was_seen_as_far_as_it_should_be() -> None:
    beyond, own = NextButOne(NextButOneParameters(share=1.0)), NOBODY_MOVES.at(2.0)
    neighbor = flown(beyond)
    expected = beyond.expected(neighbor, own, 2.0, 0.4)
    assert beyond.is_followed(2.0)
    assert expected / np.linalg.norm(expected) == pytest.approx(np.array((0.1, -0.3, 2.85)) / 2.8675, abs=0.003)
    assert np.linalg.norm(expected) == pytest.approx(math.hypot(3.05, 0.2), abs=0.01)


def test_without_a_share_or_that_ball_it_is_the_neighbor_exactly() -> None:
    for beyond, hidden in (
        (NextButOne(NextButOneParameters(share=0.0)), math.inf),
        (NextButOne(NextButOneParameters(share=0.3)), 0.0),
    ):
        neighbor = flown(beyond, hidden=hidden)
        assert beyond.at_times(neighbor, (2.1, 2.2), 0.4) == neighbor.at_times((2.1, 2.2), 0.4)


def test_forecasts_are_mixed_number_by_number() -> None:
    rng, times = np.random.default_rng(0), np.array((2.0, 2.07, 2.04))
    near, far, slow = rng.normal(size=(3, 4, 4)), rng.normal(size=(3, 4, 4)), rng.normal(size=(2, 3))
    expected = near.copy()
    for k, time in enumerate(times - times[0]):
        for axis in range(3):
            away = np.array((slow[0, axis] + time * slow[1, axis], slow[1, axis], 0.0, 0.0))
            expected[k, axis] = 0.7 * near[k, axis] + 0.3 * (far[k, axis] - away)
    mix(near, far, 0.3, times, slow)
    np.testing.assert_allclose(near, expected, atol=1e-15)


def test_the_share_comes_and_goes_with_that_ball_in_its_time() -> None:
    beyond = NextButOne(NextButOneParameters(share=0.5, fade_time=0.4))
    flown(beyond, seconds=0.2 + 0.5 * STEP)
    assert 0.3 < beyond.weight < 0.6
    flown(other := NextButOne(NextButOneParameters(share=0.5)), seconds=3.0, hidden=1.0)
    assert other.weight == 0.0
    flown(still := NextButOne(NextButOneParameters(share=0.5)), seconds=3.0)
    assert still.weight == 1.0


def test_a_copy_goes_on_by_itself() -> None:
    beyond = NextButOne(NextButOneParameters(share=0.5))
    neighbor = flown(beyond, seconds=1.0)
    other = copy.deepcopy(beyond)
    before = beyond.at_times(neighbor, (1.2,), 0.4)[0].place
    for k in range(30, 40):
        other.update(pose(0.02 * (k - 29), -0.3, 2.85, k * STEP), NOBODY_MOVES.at(k * STEP))
        other.at_times(neighbor, ((k + 1) * STEP,), 0.4)
    assert beyond.at_times(neighbor, (1.2,), 0.4)[0].place == pytest.approx(before, abs=0.001)
    assert other.at_times(neighbor, (1.4,), 0.4)[0].place != pytest.approx(before, abs=0.005)


@pytest.mark.parametrize(
    ("field", "value"),
    [("share", 1.1), ("share", -0.1), ("spacing", 0.0), ("time_constant", 0.0), ("height_difference", math.inf)],
)
def test_what_cannot_be_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        NextButOneParameters(**{field: value})

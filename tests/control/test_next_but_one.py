import copy
import math

import numpy as np
import pytest

from matchset.control.chain.next_but_one import NextButOne, NextButOneParameters
from matchset.control.ego_motion import EgoMotion
from matchset.control.neighbor_filter import NeighborFilter
from matchset.localization.pose import Pose

STEP = 1.0 / 30.0
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


def place(beyond: NextButOne, neighbor: NeighborFilter, time: float) -> list[float]:
    forecast = beyond.at_times(neighbor, (time,), 0.4)[0]
    return [forecast.x.value, forecast.y.value, forecast.z.value]


def test_a_share_of_the_place_is_held_beside_the_next_but_one_ball() -> None:
    beyond = NextButOne(NextButOneParameters(share=0.25))
    neighbor = flown(beyond)
    should = np.array((0.1, -0.3, 1.5 + 1.35 - 1.55))  # where it would be if it held its place
    expected = 0.75 * np.array((0.0, -0.2, 1.5)) + 0.25 * should
    assert place(beyond, neighbor, 2.1) == pytest.approx(expected, abs=0.005)
    assert beyond.at_times(neighbor, (2.1,), 0.4)[0].yaw == neighbor.at_times((2.1,), 0.4)[0].yaw


def test_behind_the_neighbor_is_where_its_marker_looks() -> None:
    beyond = NextButOne(NextButOneParameters(share=1.0, rise=0.05))
    neighbor = flown(beyond, turn=0.3)
    yaw = neighbor.at_times((2.1,), 0.4)[0].yaw.value
    should = (0.1 + 1.55 * math.sin(yaw), -0.35, 2.85 + 1.55 * math.cos(yaw))
    assert place(beyond, neighbor, 2.1) == pytest.approx(should, abs=0.01)


def test_without_a_share_or_that_ball_it_is_the_neighbor_exactly() -> None:
    for beyond, hidden in ((NextButOne(), math.inf), (NextButOne(NextButOneParameters(share=0.3)), 0.0)):
        neighbor = flown(beyond, hidden=hidden)
        assert beyond.at_times(neighbor, (2.1, 2.2), 0.4) == neighbor.at_times((2.1, 2.2), 0.4)


def test_the_share_comes_and_goes_with_that_ball_in_its_time() -> None:
    beyond = NextButOne(NextButOneParameters(share=0.5, fade=0.4))
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
    before = place(beyond, neighbor, 1.2)
    for k in range(30, 60):
        other.update(pose(0.3, -0.3, 2.6, k * STEP), NOBODY_MOVES.at(k * STEP))
    assert place(beyond, neighbor, 1.2) == pytest.approx(before)
    assert place(other, neighbor, 2.0) != pytest.approx(before, abs=0.02)


@pytest.mark.parametrize(("field", "value"), [("share", 1.1), ("share", -0.1), ("spacing", 0.0), ("rise", math.inf)])
def test_what_cannot_be_is_refused(field: str, value: float) -> None:
    with pytest.raises(ValueError, match=field):
        NextButOneParameters(**{field: value})

"""Several balls at once: who is who, who is new, who is hidden."""

import math

import numpy as np
import pytest

import matchset as ms
from crowds import CAMERA, TARGET, neighbors
from matchset.sim.clips.multi_ball_clip import MultiBallClip, PositionFunction

STILL: list[PositionFunction] = [lambda _: (-0.7, 0.0, 2.0), lambda _: (0.1, -0.3, 1.5), lambda _: (0.8, 0.3, 2.5)]
CROSSING: list[PositionFunction] = [lambda t: (-0.8 + 0.4 * t, 0.0, 2.0), lambda t: (0.6 - 0.3 * t, 0.02, 1.4)]
LATE: list[PositionFunction] = [lambda _: (0.0, 0.0, 1.8), lambda t: (-1.6 + 0.6 * t, 0.2, 1.8) if t > 0.5 else None]


def nearest(pose: ms.Pose, paths: list[PositionFunction], time: float) -> int:
    """Which of the balls a pose belongs to; -1 where it is none of them."""
    there = [(k, path(time)) for k, path in enumerate(paths)]
    far = {k: float(np.linalg.norm(np.subtract(place, pose.position))) for k, place in there if place is not None}
    best = min(far, key=lambda k: far[k], default=-1)
    if best < 0:
        return -1
    return best if far[best] < 0.15 else -1


def who(seed: int, paths: list[PositionFunction], frames: int) -> tuple[dict[int, set[int]], list[list[ms.Neighbor]]]:
    """Which balls each identity was seen at, and all answers."""
    watcher, answers = neighbors(seed, "typical"), []
    met: dict[int, set[int]] = {}
    for frame in MultiBallClip(camera=CAMERA, paths=paths, frames=frames, seed=seed):
        answers.append(watcher.update(frame))
        for each in answers[-1]:
            if isinstance(each.pose, ms.Pose):
                met.setdefault(each.identity, set()).add(nearest(each.pose, paths, frame.time))
    return met, answers


def test_every_ball_is_found_within_three_frames_and_one_without_a_marker_is_told_so() -> None:
    watcher = neighbors(100, "typical")
    answers = [
        watcher.update(frame)
        for frame in MultiBallClip(camera=CAMERA, paths=STILL, marked=(True, True, False), frames=12, seed=100)
    ]
    assert len(answers[3]) == 3
    for each in answers[-1]:
        assert isinstance(each.pose, ms.Pose)
        k = nearest(each.pose, STILL, 0.4)
        assert each.marked == (k != 2)
        assert each.pose.observed == ("position" if k == 2 else "level")


def test_who_is_hidden_by_another_is_the_same_afterwards() -> None:
    met, answers = who(101, CROSSING, 120)
    assert sorted(met) == [0, 1]
    assert {frozenset(balls) for balls in met.values()} == {frozenset({0}), frozenset({1})}
    reasons = {each.ball.reason for seen in answers for each in seen if isinstance(each.ball, ms.Lost)}
    assert any("hidden behind target" in reason for reason in reasons)
    last = [each for each in answers[-1] if isinstance(each.pose, ms.Pose)]
    assert len(last) == 2


def test_newcomers_are_noticed_within_half_a_second() -> None:
    met, answers = who(103, LATE, 80)
    entered = next(k for k in range(80) if (place := LATE[1](k / 30)) is not None and _in_view(place))
    noticed = next(k for k, seen in enumerate(answers) if any(each.identity == 1 for each in seen))
    assert noticed - entered <= 15
    assert met[1] == {1}


def test_nobody_is_seen_where_nobody_is() -> None:
    watcher = neighbors(104, "typical")
    assert [
        watcher.update(frame) for frame in MultiBallClip(camera=CAMERA, paths=[lambda _: None], frames=20, seed=104)
    ] == [[]] * 20


def test_who_left_is_forgotten_after_a_while() -> None:
    leaving: list[PositionFunction] = [lambda t: (0.0, 0.0, 1.8) if t < 0.3 else None]
    met, answers = who(105, leaving, 90)
    assert [each.identity for each in answers[5]] == [0]
    assert all(isinstance(each.pose, ms.Lost) for seen in answers[12:] for each in seen)
    assert answers[-1] == []
    assert met[0] <= {0, -1}


def test_a_picture_of_another_size_is_refused() -> None:
    watcher = neighbors(100, "clean")
    with pytest.raises(ValueError, match="320"):
        watcher.update(ms.Frame(np.zeros((240, 320, 3), np.uint8)))
    assert watcher.update(ms.Frame(np.zeros((480, 640, 3), np.uint8))) == []


def _in_view(place: object) -> bool:
    """Whether a ball's middle is in the picture, and three quarters of the ball with it."""
    x, _, z = np.asarray(place, np.float64)
    edge = math.atan2(x, z) - 0.5 * math.asin(0.5 * TARGET.diameter / math.hypot(x, z))
    return abs(edge) < math.atan(0.5 * CAMERA.width / CAMERA.fx)

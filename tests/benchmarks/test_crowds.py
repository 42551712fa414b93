"""Crowds of equal balls: what is rendered is possible, and who keeps which name is counted rightly."""

import math

import numpy as np
import pytest
from benchmarks.crowds.cases import PAIR, Case, cases
from benchmarks.crowds.crowd import CAMERA, MIN_VISIBLE, Crowd, Seen, shared_area
from benchmarks.crowds.pair import hidden_pair
from benchmarks.crowds.scenes import SCENES
from benchmarks.crowds.score import Answer, counted, iou, names_kept, score

import matchset as ms


def places(crowd: Crowd, seconds: float, rate: float = 60.0) -> np.ndarray:
    """Centers, (times, balls, 3), m."""
    return np.array([[path(k / rate) for path in crowd.paths] for k in range(round(seconds * rate))], float)


@pytest.mark.parametrize("balls", [2, 10, 20])
@pytest.mark.parametrize("scene", SCENES)
def test_no_two_balls_pass_through_each_other(scene: str, balls: int) -> None:
    for seed in (200, 201):
        crowd = SCENES[scene](balls, 5.0, seed)
        at = places(crowd, 5.0)
        assert at.shape[1] == balls
        one, other = np.triu_indices(balls, 1)
        nearest = np.linalg.norm(at[:, one] - at[:, other], axis=2).min()
        assert nearest > 0.95 * 2.0 * crowd.radius


@pytest.mark.parametrize("scene", SCENES)
def test_a_seed_makes_one_crowd(scene: str) -> None:
    first, again, other = (SCENES[scene](3, 0.1, seed) for seed in (5, 5, 6))
    assert np.array_equal(places(first, 1.0), places(again, 1.0))
    assert not np.array_equal(places(first, 1.0), places(other, 1.0))
    one, same = (next(iter(each))[0].image for each in (first, again))
    assert np.array_equal(one, same)


def test_balls_of_a_crossing_cross_every_two_seconds() -> None:
    crowd = SCENES["crossing"](5, 10.0, 200)
    at = places(crowd, 10.0)
    spread = (at[:, :, :2] / at[:, :, 2:]).std(axis=1).max(axis=1)
    for crossing in range(5):
        around = spread[round(60 * (2 * crossing + 0.5)) : round(60 * (2 * crossing + 1.5))]
        assert around.min() < 0.25 * spread.max()
        assert abs(int(around.argmin()) - 30) < 15


def test_balls_of_a_swarm_leave_the_view_and_come_back() -> None:
    crowd = SCENES["swarm"](10, 30.0, 200)
    seen = np.array([[each.visible > 0.0 for each in crowd.truth(k / 4.0)] for k in range(120)])
    out = [ball for ball in seen.T if not ball.all()]
    assert out
    assert any(np.diff(ball.astype(int)).max() == 1 for ball in out)


def test_hands_hide_what_they_hold() -> None:
    crowd = SCENES["juggling"](3, 4.0, 200)
    shares = np.array([[each.visible for each in crowd.truth(k / 30.0)] for k in range(120)])
    assert (shares.min(axis=0) < MIN_VISIBLE).all()
    assert (shares > 0.99).mean() > 0.5
    without = Crowd(crowd.paths, 1, 200, radius=crowd.radius)
    assert without.truth(0.0) != crowd.truth(0.0) or (shares[0] > 0.99).all()


def between(seen: list[Seen]) -> np.ndarray:
    """From the first of two balls to the other, px."""
    one, other = (each.circle for each in seen)
    return np.array((other.x - one.x, other.y - one.y))


def test_one_ball_of_a_pair_is_hidden_for_a_second_and_both_come_out() -> None:
    sides = []
    for seed in range(200, 215):
        crowd = hidden_pair(seed)
        truth = [crowd.truth(k / 30.0) for k in range(crowd.frames)]
        shares = np.array([[each.visible for each in seen] for seen in truth])
        far = int(shares[75].argmin())
        assert 0.9 < (shares[:, far] < MIN_VISIBLE).sum() / 30.0 < 1.1
        assert shares[:, 1 - far].min() > 0.95
        assert min(shares[:25].min(), shares[-25:].min()) > 0.9
        before, after = (between(truth[k]) for k in (0, -1))
        sides.append(float(before @ after) > 0.0)
    assert sides == [seed % 3 == 0 for seed in range(200, 215)]


def test_the_share_that_is_seen_is_that_of_the_discs() -> None:
    near, far = (0.0, 0.0, 1.6), (0.12, 0.0, 2.0)
    seen = Crowd([lambda _: far, lambda _: near], 1, 0).truth(0.0)
    a, b = (each.circle for each in seen)
    hidden = shared_area(a.radius, b.radius, math.hypot(a.x - b.x, a.y - b.y)) / (math.pi * a.radius**2)
    assert seen[0].visible == pytest.approx(1.0 - hidden, abs=0.02)
    assert seen[1].visible == pytest.approx(1.0, abs=0.01)
    assert Crowd([lambda _: (9.0, 0.0, 2.0)], 1, 0).truth(0.0)[0].visible == 0.0
    assert Crowd([lambda _: None], 1, 0).truth(0.0) == []


def test_what_is_drawn_is_where_the_truth_says() -> None:
    crowd = SCENES["crossing"](2, 0.1, 201, "clean")
    frame, seen = next(iter(crowd))
    for each in seen:
        assert ms.ColorModel.pick(frame.image, each.circle.x, each.circle.y)
    circles = [track.shape for track in ms.detect(frame, ms.Circle, color_at(frame, seen[0].circle), limit=4)]
    for each in seen:
        assert max(iou(each.circle, circle) for circle in circles) > 0.95


def color_at(frame: ms.Frame, circle: ms.Circle) -> ms.ColorModel:
    return ms.ColorModel.pick(frame.image, circle.x, circle.y)


def toy(frames: int = 40) -> list[list[Seen]]:
    """Two balls beside each other."""
    return [
        [Seen(0, ms.Circle(100.0 + k, 100.0, 20.0), 1.0), Seen(1, ms.Circle(100.0 + k, 300.0, 20.0), 1.0)]
        for k in range(frames)
    ]


def said(truth: list[list[Seen]], add: int = 7) -> list[list[Answer]]:
    return [[Answer(each.identity + add, each.circle) for each in seen] for seen in truth]


def test_perfect_answers_have_all_points() -> None:
    pytest.importorskip("trackeval.metrics", exc_type=ImportError)
    found = score(toy(), said(toy()))
    assert (found.hota, found.idf1) == pytest.approx((1.0, 1.0))
    assert (found.switches, found.names, found.doubled, found.missed, found.false) == (0, 2, 0, 0.0, 0.0)


def test_names_that_change_places_are_switches() -> None:
    pytest.importorskip("trackeval.metrics", exc_type=ImportError)
    answers = said(toy())
    swapped = [[Answer(15 - each.identity, each.circle) for each in frame] for frame in answers[20:]]
    found = score(toy(), answers[:20] + swapped)
    assert (found.switches, found.names) == (2, 2)
    assert found.hota < 0.8
    assert not names_kept(toy(), answers[:20] + swapped, frames=10)
    assert names_kept(toy(), answers, frames=10)


def by_user(truth: list[list[Seen]], answers: list[list[Answer]]) -> tuple[float, float, int, float]:
    return counted(zip(truth, answers, strict=True))


def test_a_user_counts_what_is_missed_false_and_renamed() -> None:
    truth, answers = toy(10), said(toy(10))
    assert by_user(truth, answers) == (1.0, 1.0, 0, 1.0)
    astray = Answer(30, ms.Circle(500.0, 400.0, 20.0))
    mota, recall, renamed, close = by_user(truth, [[frame[0], astray] for frame in answers])
    assert (mota, recall, renamed, close) == pytest.approx((0.0, 0.5, 0, 0.5))
    swapped = [[Answer(15 - each.identity, each.circle) for each in frame] for frame in answers[5:]]
    mota, recall, renamed, close = by_user(truth, answers[:5] + swapped)
    assert (mota, recall, renamed, close) == pytest.approx((0.9, 1.0, 2, 0.5))


@pytest.mark.parametrize(
    ("radius", "far", "right"), [(20.0, 9.9, 1), (20.0, 10.1, 0), (40.0, 19.9, 1), (40.0, 20.1, 0)]
)
def test_a_user_takes_an_answer_near_a_center_for_right(radius: float, far: float, right: int) -> None:
    truth = [[Seen(0, ms.Circle(100.0, 100.0, radius), 1.0)]]
    answer = Answer(3, ms.Circle(100.0, 100.0 + far, 0.5 * radius))
    mota, recall, _, close = by_user(truth, [[answer]])
    assert (mota, recall, close) == (2.0 * right - 1.0, right, 0.0)


def test_a_user_sees_no_hidden_ball() -> None:
    truth = [[seen[0], seen[1]._replace(visible=0.2)] for seen in toy(5)]
    for answers in (said(truth), [frame[:1] for frame in said(truth)]):
        assert by_user(truth, answers) == (1.0, 1.0, 0, 1.0)
    behind = [[seen[0], Seen(1, seen[0].circle, 0.0)] for seen in toy(5)]
    assert by_user(behind, [frame[:1] for frame in said(toy(5))]) == (1.0, 1.0, 0, 1.0)


def test_a_name_on_each_half_is_no_name_kept() -> None:
    answers = said(toy())
    both = [[frame[0], Answer(7, frame[1].circle)] for frame in answers]
    assert not names_kept(toy(), both, frames=10)
    assert not names_kept(toy(), [frame[:1] for frame in answers], frames=10)


def test_two_answers_on_one_ball_are_doubled() -> None:
    pytest.importorskip("trackeval.metrics", exc_type=ImportError)
    twice = [[*frame, Answer(20, ms.Circle(frame[0].circle.x + 1.0, frame[0].circle.y, 20.0))] for frame in said(toy())]
    found = score(toy(), twice)
    assert (found.doubled, found.names) == (40, 3)
    assert found.false == pytest.approx(1.0 / 3.0)


def test_two_balls_that_nearly_coincide_are_not_doubled() -> None:
    pytest.importorskip("trackeval.metrics", exc_type=ImportError)
    truth = [[Seen(0, ms.Circle(100.0, 100.0, 20.0), 0.4), Seen(1, ms.Circle(108.0, 100.0, 20.0), 1.0)]] * 5
    assert score(truth, said(truth)).doubled == 0


def test_hidden_balls_count_neither_for_nor_against() -> None:
    pytest.importorskip("trackeval.metrics", exc_type=ImportError)
    truth = [[seen[0], seen[1]._replace(visible=0.2)] for seen in toy()]
    for answers in (said(truth), [frame[:1] for frame in said(truth)]):
        found = score(truth, answers)
        assert (found.hota, found.missed, found.false) == pytest.approx((1.0, 0.0, 0.0))


def test_an_answer_on_a_hidden_ball_is_not_taken_for_the_one_before_it() -> None:
    pytest.importorskip("trackeval.metrics", exc_type=ImportError)
    truth, answers = toy(9), said(toy(9))
    for k in (4, 5):
        behind = ms.Circle(truth[k][0].circle.x + 5.0, 100.0, 20.0)
        truth[k] = [truth[k][0], Seen(1, behind, 0.2)]
        answers[k] = [Answer(8, behind)]
    found = score(truth, answers)
    assert found.switches == 0
    assert found.missed == pytest.approx(2.0 / 16.0)


def test_cases_are_listed_and_checked() -> None:
    listed = cases(["swarm", PAIR], [2, 5], 3.0, (200, 201))
    assert [(each.scene, each.balls, each.seconds, each.seed) for each in listed[3:5]] == [
        ("swarm", 5, 3.0, 201),
        (PAIR, 2, 5.0, 200),
    ]
    with pytest.raises(ValueError, match="got 'chess'"):
        Case("chess", 2, 1.0, 0)
    with pytest.raises(ValueError, match="21"):
        Case("swarm", 21, 1.0, 0)
    assert CAMERA.width == 640

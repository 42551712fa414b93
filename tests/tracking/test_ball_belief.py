"""What is believed of a ball: renewed, relit, copied; and whole films of small fast balls, rendered."""

import copy
import pickle

import cv2
import numpy as np
import pytest
from scenes import BLUE, FPS, Answer, Picture, off, run, with_ball

import matchset as ms
from matchset.tracking.ball.belief import Belief
from matchset.tracking.tracker import Tracker

RADIUS, WAY, SIDE = 6.0, 30.0, 40.0  # px, px a picture, px from the border where it turns round
PICTURES = 60
RESTING = 250.0, 200.0


def wall() -> Picture:
    """Gray wall with coarse texture."""
    noise = np.random.default_rng(4).normal(0.0, 1.0, (240, 320, 3))
    coarse = cv2.GaussianBlur(noise, (0, 0), 2.0)
    return np.asarray(np.clip(150.0 + 6.0 * coarse / coarse.std(), 0, 255), np.uint8)


WALL = wall()


def place(index: int) -> tuple[float, float]:
    """Where the fast ball is: it flies from side to side, and turns round within a picture."""
    length = 320.0 - 2.0 * SIDE
    along = (WAY * index) % (2.0 * length)
    across = min(along, 2.0 * length - along)
    return SIDE + across, 80.0 + 0.2 * across


def shown(ball: tuple[float, float] | None, index: int, others: tuple[tuple[float, float], ...] = ()) -> Picture:
    image = WALL
    for x, y in (*others, *([] if ball is None else [ball])):
        image = with_ball(image, x, y, RADIUS)
    noisy = image + np.random.default_rng(index).normal(0.0, 1.5, image.shape)
    return np.asarray(np.clip(np.rint(noisy), 0, 255), np.uint8)


def fast(count: int, others: tuple[tuple[float, float], ...] = ()) -> list[Picture]:
    return [shown(place(k), k, others) for k in range(count)]


def tracker_of(first: Picture) -> Tracker[ms.Circle]:
    return ms.Tracker(ms.Circle, ms.ColorModel.pick(first, *place(0)), start=place(0), fps=FPS)


def belief_of(tracker: Tracker[ms.Circle]) -> Belief:
    assert tracker._ball.belief is not None
    return tracker._ball.belief


def errors(answers: list[Answer]) -> list[float]:
    return [off(answer, (*place(k), RADIUS)) for k, answer in enumerate(answers)]


def test_a_small_fast_ball_that_turns_round_is_followed_in_every_picture() -> None:
    pictures = fast(PICTURES)
    found = errors(run(tracker_of(pictures[0]), pictures))
    assert [k for k, error in enumerate(found) if error > 0.5 * RADIUS] == []


def test_an_equal_ball_at_rest_is_never_taken_for_it() -> None:
    pictures = fast(PICTURES, (RESTING,))
    answers = run(tracker_of(pictures[0]), pictures)
    on_other = [k for k, each in enumerate(answers) if off(each, (*RESTING, RADIUS)) < 2.0 * RADIUS]
    assert on_other == []
    assert sum(error > 0.5 * RADIUS for error in errors(answers)) <= 2


def test_an_equal_ball_at_rest_is_not_taken_for_one_that_has_left() -> None:
    pictures = [*fast(20, (RESTING,)), *(shown(None, k, (RESTING,)) for k in range(20, 60))]
    answers = run(tracker_of(pictures[0]), pictures)
    assert not any(answers[20:])


def resting(count: int, gain: float = 1.0) -> list[Picture]:
    """Pictures of a ball at rest in some light."""
    lit = [np.clip(gain * shown(place(0), k), 0.0, 255.0) for k in range(count)]
    return [np.asarray(np.rint(each), np.uint8) for each in lit]


def test_the_belief_is_renewed_by_its_age_and_not_in_every_picture() -> None:
    pictures = resting(40)
    tracker, times = tracker_of(pictures[0]), list[float]()
    for k, image in enumerate(pictures):
        run(tracker, [image], k)
        times.append(belief_of(tracker).time)
    renewed = sorted(set(times))
    assert 3 < len(renewed) < 8
    assert min(np.diff(renewed)) >= tracker.parameters.ball.renewed_s


def test_the_color_that_is_believed_is_that_of_its_middle() -> None:
    pictures = resting(10)
    tracker = tracker_of(pictures[0])
    run(tracker, pictures)
    belief = belief_of(tracker)
    assert belief.pixel == pytest.approx(BLUE, abs=3.0)
    assert belief.circle == pytest.approx((*place(0), RADIUS), abs=0.5)
    assert np.exp(belief.size[0]) == pytest.approx(RADIUS, abs=0.3)
    assert belief.reference is not None
    assert belief.reference.circle == pytest.approx((*place(0), RADIUS), abs=0.5)


def test_in_another_light_pixel_and_reference_are_multiplied_and_the_rest_stays() -> None:
    tracker = tracker_of(resting(1)[0])
    run(tracker, resting(5))
    before = belief_of(tracker)
    gains = np.array((0.5, 0.8, 1.1))
    tracker._ball.relight(gains)
    after = belief_of(tracker)
    assert after.pixel == pytest.approx(before.pixel * gains, abs=0.01)
    assert before.reference is not None
    assert after.reference is not None
    expected = np.clip(before.reference.picture * gains, 0.0, 255.0)
    assert np.abs(after.reference.picture - expected).max() <= 0.51
    assert (after.circle, after.size, after.time) == (before.circle, before.size, before.time)
    assert np.abs(after.lab - before.lab).max() > 5.0
    assert before.pixel == pytest.approx(BLUE, abs=3.0), "it is replaced, not changed"


def test_after_a_restart_nothing_is_believed() -> None:
    tracker = tracker_of(resting(1)[0])
    run(tracker, resting(5))
    tracker.restart(place(0))
    assert tracker._ball.belief is None
    assert not tracker._ball.knows()


@pytest.mark.parametrize("how", ["copied", "pickled"])
def test_a_tracker_in_mid_flight_goes_on_alike_once_it_is_copied_or_pickled(how: str) -> None:
    pictures = [*fast(24, (RESTING,)), *(shown(None, k, (RESTING,)) for k in range(24, 30)), *fast(40, (RESTING,))[30:]]
    tracker = tracker_of(pictures[0])
    run(tracker, pictures[:27])  # it is lost, and has been looked for
    other = copy.deepcopy(tracker) if how == "copied" else pickle.loads(pickle.dumps(tracker))
    one, two = (run(each, pictures[27:], 27) for each in (tracker, other))
    assert any(one)
    for first, second in zip(one, two, strict=True):
        assert bool(first) == bool(second)
        if isinstance(first, ms.Track) and isinstance(second, ms.Track):
            assert first.shape == second.shape
            assert np.array_equal(first.covariance, second.covariance)


def test_a_belief_itself_can_be_copied_and_pickled() -> None:
    pictures = fast(12)
    tracker = tracker_of(pictures[0])
    run(tracker, pictures)
    belief = belief_of(tracker)
    for other in (copy.deepcopy(belief), pickle.loads(pickle.dumps(belief))):
        assert isinstance(other, Belief)
        assert other._replace(lab=belief.lab, pixel=belief.pixel, reference=belief.reference) == belief
        assert np.array_equal(other.lab, belief.lab)
        assert np.array_equal(other.pixel, belief.pixel)
        assert belief.reference is not None
        assert other.reference is not None
        assert np.array_equal(other.reference.picture, belief.reference.picture)

"""Several targets at once: who is who, who is new, who is hidden, and what is refused."""

import copy
import pickle
from collections.abc import Callable
from typing import Any, cast

import cv2
import numpy as np
import pytest

import matchset as ms
from matchset.sim.clips.multi_ball_clip import MultiBallClip, PositionFunction
from matchset.sim.clips.truth import sphere_outline

CAMERA = ms.CameraModel.from_fov(640, 480, 1.25)
BLUE, GREEN = (200, 60, 30), (60, 170, 40)
Centers = dict[int, tuple[float, float]]


def drawn(places: list[tuple[float, float]], color: tuple[int, int, int] = BLUE, radius: int = 24) -> np.ndarray:
    """Discs on gray, the first one behind all others."""
    image = np.full((240, 400, 3), 110, np.uint8)
    for x, y in places:
        center = round(16 * x), round(16 * y)
        cv2.circle(image, center, 16 * radius, color, -1, cv2.LINE_AA, 4)
        cv2.circle(image, center, 16 * radius, tuple(0.7 * each for each in color), 3, cv2.LINE_AA, 4)
    return image


def picked(places: list[tuple[float, float]], color: tuple[int, int, int] = BLUE) -> ms.ColorModel:
    return ms.ColorModel.pick(drawn(places, color), *places[0])


def found(targets: list[ms.Target[ms.Circle]]) -> Centers:
    """Centers of what is seen, by identity."""
    seen = [(each.identity, each.track.shape) for each in targets if isinstance(each.track, ms.Track)]
    return {identity: (shape.x, shape.y) for identity, shape in seen}


def followed(
    tracker: ms.MultiTracker, course: Callable[[int], list[tuple[float, float]]], frames: int
) -> list[list[ms.Target[ms.Circle]]]:
    return [tracker.update(drawn(course(k))) for k in range(frames)]


def test_all_that_is_there_has_an_identity_that_it_keeps() -> None:
    def course(k: int) -> list[tuple[float, float]]:
        return [(60.0 + 2.0 * k, 60.0), (200.0, 180.0 - 1.5 * k), (330.0 - 2.0 * k, 180.0)]

    answers = followed(ms.MultiTracker(ms.Circle, picked(course(0))), course, 30)
    assert [each.identity for each in answers[-1]] == [0, 1, 2]
    for k in range(6, 30):
        assert sorted(found(answers[k])) == [0, 1, 2]
        for place in course(k):
            near = min(np.hypot(x - place[0], y - place[1]) for x, y in found(answers[k]).values())
            assert near < 0.3
    for identity in range(3):
        way = np.array([found(answers[k])[identity] for k in range(6, 30)])
        assert np.abs(np.diff(way, axis=0)).max() < 3.0


@pytest.mark.parametrize("seed", [11, 12, 13])
def test_one_that_hides_behind_another_has_its_name_afterwards(seed: int) -> None:
    paths: list[PositionFunction] = [lambda t: (-0.8 + 0.4 * t, 0.0, 2.0), lambda t: (0.6 - 0.3 * t, 0.02, 1.4)]
    clip = MultiBallClip(camera=CAMERA, paths=paths, marked=(False, False), frames=120, seed=seed)
    met: dict[int, set[int]] = {}
    tracker, reasons = None, set[str]()
    for frame in clip:
        places = [sphere_outline(CAMERA, np.array(path(frame.time)), 0.14).circle() for path in paths]
        tracker = tracker or ms.MultiTracker(ms.Circle, ms.ColorModel.pick(frame.image, places[1].x, places[1].y))
        for each in tracker.update(frame):
            if isinstance(each.track, ms.Lost):
                reasons.add(each.track.reason)
                assert each.track.predicted is not None
                continue
            far = [np.hypot(each.track.shape.x - circle.x, each.track.shape.y - circle.y) for circle in places]
            met.setdefault(each.identity, set()).add(int(np.argmin(far)))
            assert min(far) < 0.5 * places[int(np.argmin(far))].radius
    assert sorted(met) == [0, 1]
    assert all(len(balls) == 1 for balls in met.values())
    assert any("hidden behind target" in reason for reason in reasons)


def test_a_ball_that_is_thrown_behind_a_wall_keeps_its_name() -> None:
    def course(k: int) -> tuple[float, float]:
        t = k / 30.0
        return 40.0 + 260.0 * t, 200.0 - 420.0 * t + 0.5 * 900.0 * t * t

    color = picked([course(0), course(0)])
    tracker, answers = ms.MultiTracker(ms.Circle, color), []
    for k in range(32):
        image = drawn([course(k)], radius=16)
        image[:, 150:230] = (40, 40, 40)
        answers.append(found(tracker.update(image)))
    assert set().union(*answers) == {0}
    assert any(not each for each in answers[12:26])
    assert answers[-1]


def test_who_left_is_forgotten_and_its_number_is_not_given_again() -> None:
    tracker = ms.MultiTracker(ms.Circle, picked([(60.0, 60.0)]))
    for _ in range(5):
        tracker.update(drawn([(60.0, 60.0)]))
    assert isinstance(tracker.update(drawn([]))[0].track, ms.Lost)
    for _ in range(65):
        last = tracker.update(drawn([]))
    assert last == []
    for _ in range(5):
        last = tracker.update(drawn([(300.0, 150.0)]))
    assert [(each.identity, bool(each.track)) for each in last] == [(1, True)]
    assert last[0].since > 70.0 / 30.0


def test_nobody_is_seen_where_nobody_is() -> None:
    tracker = ms.MultiTracker(ms.Circle, picked([(60.0, 60.0)]))
    noise = np.random.default_rng(3)
    for _ in range(20):
        assert tracker.update(noise.integers(0, 255, (240, 400, 3), np.uint8)) == []


def test_labels_are_those_of_the_colors() -> None:
    image = drawn([(80.0, 80.0)])
    image[:, 200:] = drawn([(300.0, 150.0)], GREEN)[:, 200:]
    colors = {"blue": picked([(80.0, 80.0)]), "green": picked([(300.0, 150.0)], GREEN)}
    tracker = ms.MultiTracker(ms.Circle, colors)
    for _ in range(10):
        targets = tracker.update(image)
    assert {each.label: round(found(targets)[each.identity][0]) for each in targets} == {"blue": 80, "green": 300}


def test_a_hidden_target_is_not_found_in_one_of_another_color() -> None:
    colors = {"blue": picked([(80.0, 80.0)]), "green": picked([(80.0, 80.0)], GREEN)}
    tracker = ms.MultiTracker(ms.Circle, colors)
    for k in range(24):
        blue = k < 10
        image = drawn([(80.0, 80.0)], BLUE if blue else GREEN)
        targets = tracker.update(image)
        assert {each.label for each in targets if each.track} <= {"blue" if blue else "green"}
    assert {each.label: each.identity for each in targets} == {"blue": 0, "green": 1}


def test_families_may_differ() -> None:
    image = drawn([(80.0, 80.0)])
    cv2.rectangle(image, (260, 120), (340, 180), GREEN, -1)
    families = {"ball": ms.Circle, "plate": ms.Rectangle}
    colors = {"ball": picked([(80.0, 80.0)]), "plate": ms.ColorModel.pick(image, 300.0, 150.0)}
    tracker = ms.MultiTracker(families, colors)
    for _ in range(10):
        targets = tracker.update(image)
    kinds = {each.label: type(each.track.shape) for each in targets if isinstance(each.track, ms.Track)}
    assert kinds == {"ball": ms.Circle, "plate": ms.Rectangle}


def test_what_is_added_is_followed_and_nothing_else_if_nothing_is_searched_for() -> None:
    places = [(60.0, 60.0), (200.0, 120.0), (330.0, 180.0)]
    tracker = ms.MultiTracker(ms.Circle, picked(places), finds=False)
    assert tracker.update(drawn(places)) == []
    tracker.add((205.0, 125.0))
    tracker.add(ms.Circle(328.0, 181.0, 23.0))
    for _ in range(3):
        targets = tracker.update(drawn(places))
    assert sorted((round(x), round(y)) for x, y in found(targets).values()) == [(200, 120), (330, 180)]
    with pytest.raises(ValueError, match=r"at \(201, 119\) is target \d, followed already"):
        tracker.add((201.0, 119.0))
    tracker.remove(targets[0].identity)
    assert [each.identity for each in tracker.update(drawn(places))] == [targets[1].identity]
    with pytest.raises(ValueError, match="there is no target 7"):
        tracker.remove(7)


def test_what_is_not_named_is_not_followed_either_while_another_one_is_hidden() -> None:
    tracker = ms.MultiTracker(ms.Circle, picked([(60.0, 60.0)]), finds=False)
    tracker.add((60.0, 60.0))
    for k in range(40):
        places = [(200.0, 120.0), (330.0, 180.0), *([(60.0, 60.0)] if k < 5 else [])]
        targets = tracker.update(drawn(places))
        assert len(targets) <= 1
    assert not found(targets)


def test_a_point_where_nothing_is_is_forgotten() -> None:
    tracker = ms.MultiTracker(ms.Circle, picked([(60.0, 60.0)]), finds=False)
    tracker.add((300.0, 150.0))
    for _ in range(25):
        assert tracker.update(drawn([(60.0, 60.0)])) == []
    for _ in range(3):
        assert tracker.update(drawn([(300.0, 150.0)])) == []


def test_no_more_than_most_are_followed() -> None:
    places = [(50.0 + 60.0 * k, 60.0 + 90.0 * row) for k in range(6) for row in range(2)]
    tracker = ms.MultiTracker(ms.Circle, picked(places), most=5)
    for _ in range(20):
        targets = tracker.update(drawn(places))
    assert len(targets) == 5
    with pytest.raises(ValueError, match="5 targets are followed already"):
        tracker.add((390.0, 10.0))


@pytest.mark.parametrize("how", [copy.deepcopy, lambda tracker: pickle.loads(pickle.dumps(tracker))])
def test_a_copy_goes_on_as_the_first_one_does(how: Callable[[ms.MultiTracker], ms.MultiTracker]) -> None:
    def course(k: int) -> list[tuple[float, float]]:
        return [(60.0 + 5.0 * k, 100.0), (340.0 - 5.0 * k, 110.0)]

    tracker = ms.MultiTracker(ms.Circle, picked(course(0)))
    for k in range(26):
        tracker.update(drawn(course(k)))
    other = how(tracker)
    for k in range(26, 50):
        assert found(tracker.update(drawn(course(k)))) == found(other.update(drawn(course(k))))


def test_half_frames_are_followed_at_their_own_times() -> None:
    places = [(100.0, 100.0), (300.0, 150.0)]
    tracker = ms.MultiTracker(ms.Circle, picked(places))
    for k in range(20):
        frame = ms.Frame(drawn(places), k / 60.0, k, rows="top" if k % 2 else "bottom")
        targets = tracker.update(frame)
    assert sorted(round(x) for x, _ in found(targets).values()) == [100, 300]
    assert targets[0].track.time == pytest.approx(19 / 60.0)


def test_many_sightings_take_bounded_work() -> None:
    places = [(20.0 + 19.0 * k, 15.0 + 18.0 * row) for k in range(20) for row in range(12)]
    tracker = ms.MultiTracker(ms.Circle, picked([(60.0, 60.0)]), most=20)
    image = drawn(places, radius=8)
    for _ in range(12):
        assert len(tracker.update(image)) <= 20


def test_misuse_is_refused_with_the_value() -> None:
    blue, green = picked([(60.0, 60.0)]), picked([(60.0, 60.0)], GREEN)
    with pytest.raises(ValueError, match="most must be a whole number, 1 to 100, got 0"):
        ms.MultiTracker(ms.Circle, blue, most=0)
    with pytest.raises(ValueError, match="'0' and '1' are the same"):
        ms.MultiTracker(ms.Circle, [blue, blue.copy()])
    with pytest.raises(ValueError, match="got none"):
        ms.MultiTracker(ms.Circle, {})
    with pytest.raises(TypeError, match="ColorModel"):
        ms.MultiTracker(ms.Circle, cast(Any, {"blue": "blue.npz"}))
    with pytest.raises(ValueError, match="same labels"):
        ms.MultiTracker({"a": ms.Circle}, {"b": blue})
    tracker = ms.MultiTracker(ms.Circle, {"blue": blue, "green": green})
    with pytest.raises(ValueError, match="'blue', 'green', got None"):
        tracker.add((10.0, 10.0))
    with pytest.raises(ValueError, match="must be finite"):
        tracker.add((np.nan, 10.0), "blue")
    with pytest.raises(ValueError, match="of the family Circle"):
        tracker.add(ms.Rectangle(50.0, 50.0, 10.0, 10.0, 0.0), "blue")
    tracker.update(drawn([(60.0, 60.0)]))
    with pytest.raises(ValueError, match="has shape"):
        tracker.update(np.zeros((100, 100, 3), np.uint8))


def test_it_says_in_a_line_what_it_follows() -> None:
    tracker = ms.MultiTracker(ms.Circle, picked([(60.0, 60.0)]))
    for _ in range(4):
        tracker.update(drawn([(60.0, 60.0)]))
    assert repr(tracker) == "MultiTracker(1 targets followed, 1 found, 4 frames)"

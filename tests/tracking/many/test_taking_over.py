"""Targets that another tracker has followed so far, and what is found without a click while one is hidden."""

import math
from collections.abc import Callable

import cv2
import numpy as np
import pytest

import matchset as ms
from matchset.tracking.many.parameters import MultiTrackerParameters

Places = list[tuple[float, float]]
Targets = list["ms.Target[ms.Circle]"]
BLUE, RADIUS = (200, 60, 30), 24
FOR_EVER = MultiTrackerParameters(memory=math.inf, searched=0.3)


def drawn(places: Places) -> np.ndarray:
    """Discs with rims on gray, the first one behind all others."""
    image = np.full((240, 400, 3), 110, np.uint8)
    for x, y in places:
        center = round(16 * x), round(16 * y)
        cv2.circle(image, center, 16 * RADIUS, BLUE, -1, cv2.LINE_AA, 4)
        cv2.circle(image, center, 16 * RADIUS, tuple(0.7 * each for each in BLUE), 3, cv2.LINE_AA, 4)
    return image


def picked(places: Places) -> ms.ColorModel:
    return ms.ColorModel.pick(drawn(places), *places[0])


def found(targets: Targets) -> dict[int, tuple[float, float]]:
    """Centers of what is seen, by identity."""
    seen = [(each.identity, each.track.shape) for each in targets if isinstance(each.track, ms.Track)]
    return {identity: (shape.x, shape.y) for identity, shape in seen}


def tracks(places: Places) -> list["ms.Track[ms.Circle]"]:
    """What trackers of their own find there, at 0 s."""
    found = []
    for place in places:
        tracker = ms.Tracker(ms.Circle, picked(places))
        tracker.start(ms.Circle(*place, 24.0))
        answer = tracker.update(ms.Frame(drawn(places), 0.0, 0))
        assert isinstance(answer, ms.Track)
        found.append(answer)
    return found


def follow(
    tracker: ms.MultiTracker, course: Callable[[int], Places], first: int, last: int
) -> list["ms.Target[ms.Circle]"]:
    targets: list[ms.Target[ms.Circle]] = []
    for k in range(first, last):
        targets = tracker.update(ms.Frame(drawn(course(k)), k / 30.0, k))
    return targets


def test_what_others_have_followed_is_taken_over_with_its_identity() -> None:
    def course(k: int) -> Places:
        return [(80.0 + 4.0 * k, 118.0), (320.0 - 4.0 * k, 122.0)]

    tracker = ms.MultiTracker(ms.Circle, picked(course(0)), finds=False)
    assert [tracker.add(track) for track in tracks(course(0))] == [0, 1]
    first = follow(tracker, course, 1, 2)
    assert found(first) == {0: pytest.approx(course(1)[0], abs=1.0), 1: pytest.approx(course(1)[1], abs=1.0)}
    assert [each.since for each in first] == [0.0, 0.0]
    behind = set()
    for k in range(2, 56):
        behind |= {(each.identity, each.behind) for each in tracker.update(ms.Frame(drawn(course(k)), k / 30.0, k))}
    assert behind > {(0, None), (1, None)}  # one was hidden behind the other
    last = follow(tracker, course, 56, 60)
    assert found(last) == {0: pytest.approx(course(59)[0], abs=1.0), 1: pytest.approx(course(59)[1], abs=1.0)}


def test_a_click_has_the_identity_that_was_told() -> None:
    places = [(80.0, 110.0), (320.0, 130.0)]
    tracker = ms.MultiTracker(ms.Circle, picked(places), finds=False)
    assert tracker.add((10.0, 10.0)) == 0  # there is nothing
    assert tracker.add(places[1]) == 1
    assert found(follow(tracker, lambda _: places, 0, 3)) == {1: pytest.approx(places[1], abs=1.0)}


def test_one_that_is_hidden_is_found_where_it_comes_out_and_nothing_else_begins() -> None:
    places = [(80.0, 60.0), (320.0, 180.0)]
    tracker = ms.MultiTracker(ms.Circle, picked(places), parameters=FOR_EVER, finds=False)
    one, other = tracks(places)
    assert tracker.add(one) == 0
    assert tracker.add(other, hidden=True) == 1
    for k in range(1, 150):
        targets = follow(tracker, lambda k: places[:1] if k < 100 else [places[0], (200.0, 100.0)], k, k + 1)
        assert [each.identity for each in targets] == [0, 1]  # it is not forgotten, and there is no third one
        assert found(targets)[0] == pytest.approx(places[0], abs=1.0)
        assert (1 in found(targets)) <= (k >= 100)
    assert found(targets)[1] == pytest.approx((200.0, 100.0), abs=1.0)


def test_whether_all_are_found_may_be_changed() -> None:
    places = [(80.0, 60.0), (320.0, 180.0)]
    tracker = ms.MultiTracker(ms.Circle, picked(places), finds=False)
    tracker.add(places[0])
    assert list(found(follow(tracker, lambda _: places, 0, 10))) == [0]
    tracker.finds = True
    assert tracker.finds
    assert list(found(follow(tracker, lambda _: places, 10, 20))) == [0, 1]
    tracker.finds = False
    more = [*places, (200.0, 60.0)]
    assert list(found(follow(tracker, lambda _: more, 20, 40))) == [0, 1]


def test_what_cannot_be_taken_over_is_said() -> None:
    places = [(80.0, 60.0), (320.0, 180.0)]
    one, other = tracks(places)
    tracker = ms.MultiTracker(ms.Circle, picked(places), most=1, finds=False)
    tracker.add(one)
    with pytest.raises(ValueError, match="1 targets are followed already"):
        tracker.add(other)
    rectangles = ms.MultiTracker(ms.Rectangle, picked(places), finds=False)
    with pytest.raises(ValueError, match="of the family Rectangle"):
        rectangles.add(one)

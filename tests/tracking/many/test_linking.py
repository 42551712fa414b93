"""Whose a tracklet is: the joint decision, doubts, and what becomes of slots."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.tracking.many.linking import Linking, LinkingParameters
from matchset.tracking.many.motion_bank import ManyMotionParameters, Predicted
from matchset.tracking.many.observer import near_pairs
from matchset.tracking.many.sightings import MergeParameters, Sighting, are_fields, of_both, sighting_of
from matchset.tracking.many.tracklet import Followed, Observed, Tracklet
from matchset.tracking.motion import Gate

STEP = 1.0 / 30.0
MOTION = ManyMotionParameters()


def sighting(x: float, y: float, radius: float = 20.0, time: float = 0.0) -> Sighting:
    track = ms.Track(ms.Circle(x, y, radius), 0.01 * np.eye(3), 1.0, np.zeros((0, 2)), time)
    return sighting_of(track, MOTION.center_sigmas, "0")


class Scene:
    """Targets that are seen at given places, frame by frame."""

    def __init__(self, most: int = 8) -> None:
        self.linking = Linking(most, MOTION, LinkingParameters())
        self.time = 0.0

    def frame(self, seen: dict[Tracklet, Sighting], fresh: list[Sighting]) -> None:
        predicted = Predicted(self.linking.bank, self.time)
        ended = [each for each in self.linking.tracklets if each not in seen]
        observed = Observed(dict(seen), ended, list(fresh))
        self.linking.bridge(observed, predicted)
        lost = self.linking.end(observed.ended, self.time)
        self.linking.doubt(lost, observed.continued, predicted)
        self.linking.go_on(observed.continued, self.time, calm=False)
        self.linking.begin(observed.fresh, predicted, self.time)
        self.linking.decide(self.time)
        self.time += STEP

    def two(self, frames: int) -> tuple[Followed, Followed]:
        """Follow two that move toward each other at 6 px a frame, until they are 40 px apart."""
        self.frame({}, [self._left(0), self._right(0, frames)])
        for k in range(1, frames):
            left, right = self.linking.tracklets
            self.frame({left: self._left(k), right: self._right(k, frames)}, [])
        one, other = self.linking.targets
        return one, other

    def _left(self, k: int) -> Sighting:
        return sighting(100.0 + 6.0 * k, 100.0)

    def _right(self, k: int, frames: int) -> Sighting:
        return sighting(140.0 + 6.0 * (2 * frames - k), 103.0, 18.0)


def test_two_that_are_seen_again_behind_each_other_have_gone_on() -> None:
    scene = Scene()
    one, other = scene.two(12)
    for _ in range(6):
        scene.frame({}, [])
    assert scene.linking.hidden() == [one, other]
    k = 18
    scene.frame({}, [scene._left(k), scene._right(k, 12)])
    for k in range(19, 24):
        a, b = scene.linking.tracklets
        scene.frame({a: scene._left(k), b: scene._right(k, 12)}, [])
    a, b = scene.linking.tracklets
    assert a.owner() is one
    assert b.owner() is other
    assert one.slot == a.hypotheses[one].slot
    assert other.slot == b.hypotheses[other].slot
    assert a.is_certain
    assert b.is_certain


def test_new_ones_whose_trackers_lose_them_go_on_with_what_is_found_next_to_them() -> None:
    scene = Scene()
    scene.frame({}, [sighting(100.0, 100.0), sighting(300.0, 100.0)])
    first = list(scene.linking.tracklets)
    for each in first:
        each.is_certain = False
    scene.frame({}, [sighting(270.0, 100.0), sighting(130.0, 100.0)])
    assert scene.linking.tracklets == first
    assert [each.sighting.place.x for each in first] == [130.0, 270.0]


def test_what_is_found_far_from_one_in_doubt_is_another_one() -> None:
    scene = Scene()
    scene.frame({}, [sighting(100.0, 100.0)])
    (first,) = scene.linking.tracklets
    first.is_certain = False
    scene.frame({}, [sighting(400.0, 100.0)])
    assert first not in scene.linking.tracklets
    assert len(scene.linking.tracklets) == 1


def test_one_that_was_lost_beside_another_may_be_what_is_seen() -> None:
    scene = Scene()
    one, other = scene.two(20)
    a, _ = scene.linking.tracklets
    scene.frame({a: scene._left(20)}, [])  # the other one, which is expected 34 px away, is not seen
    assert a.is_certain
    scene = Scene()
    one, other = scene.two(20)
    a, b = scene.linking.tracklets
    for k in (20, 21):
        scene.frame({a: scene._left(k), b: scene._right(k, 20)}, [])
    scene.frame({a: sighting(240.0, 101.5, 19.0)}, [])  # midway between both, 16 px apart
    assert set(a.hypotheses) == {one, other}
    assert not a.is_certain


def test_what_is_nowhere_near_is_new() -> None:
    scene = Scene()
    scene.two(12)
    scene.frame({}, [sighting(400.0, 400.0)])
    for _ in range(4):
        tracklets = {each: sighting(400.0, 400.0) for each in scene.linking.tracklets}
        scene.frame(tracklets, [])
    assert len(scene.linking.targets) == 3


def test_no_more_targets_than_most() -> None:
    scene = Scene(most=3)
    for _ in range(3):
        scene.frame(
            {each: each.sighting for each in scene.linking.tracklets}, [sighting(80.0 * k, 50.0) for k in range(6)]
        )
    assert len(scene.linking.targets) == 3


def test_slots_of_what_is_forgotten_are_used_again() -> None:
    scene = Scene()
    for _ in range(30):
        scene.frame({}, [sighting(100.0, 100.0), sighting(300.0, 100.0)])
        scene.frame({}, [])
        scene.linking.forget(scene.time, 0.0, 0.0)
    assert scene.linking.targets == []
    assert len(scene.linking.bank._free) == len(scene.linking.bank._size)


places = st.builds(Gate, st.floats(0.0, 300.0), st.floats(0.0, 300.0), st.floats(5.0, 40.0))


@given(st.lists(places, max_size=12), st.floats(0.2, 4.0))
def test_near_pairs_are_those_of_every_pair(gates: list[Gate], distance: float) -> None:
    pairs = [
        (one, other)
        for one in range(len(gates))
        for other in range(one + 1, len(gates))
        if gates[one].distance(gates[other]) < distance * max(gates[one].half_width, gates[other].half_width)
    ]
    assert near_pairs(gates, distance) == pairs


def fields(top: tuple[float, float], bottom: tuple[float, float]) -> np.ndarray:
    """A disc in the even rows at one place, in the odd rows at another."""
    rows, columns = np.indices((120, 160))
    image = np.full((120, 160, 3), 110, np.uint8)
    for parity, (x, y) in enumerate((top, bottom)):
        image[(np.hypot(columns - x, rows - y) < 20.0) & (rows % 2 == parity)] = (200, 60, 30)
    return image


def test_the_two_fields_of_one_ball_are_not_two_balls() -> None:
    still = fields((60.0, 60.0), (60.0, 60.0))
    color = ms.ColorModel.pick(still, 60.0, 60.0)
    moving, both = (Gate(60.0, 50.0, 20.0), Gate(60.0, 66.0, 20.0)), fields((60.0, 50.0), (60.0, 66.0))
    assert are_fields(both, color, moving, MergeParameters())
    rows, columns = np.indices((120, 160))
    for x, y, _ in moving:
        still[np.hypot(columns - x, rows - y) < 20.0] = (200, 60, 30)
    assert not are_fields(still, color, moving, MergeParameters())
    middle = of_both(sighting(60.0, 50.0), sighting(60.0, 66.0))
    assert middle.place == pytest.approx((60.0, 58.0, 20.0))
    assert middle.track.shape.center == pytest.approx((60.0, 58.0))

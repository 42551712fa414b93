"""Where the network is led from several circles: its budget of looks, beside a slow twin in Python."""

import math
import threading

import numpy as np
import pytest
from ball_in_leaves import Picture, scene

from matchset.image.disc_network.network import Disc, DiscNetwork, NetworkFollowParameters
from matchset.image.disc_network.polar_patch import read_patch

Circle3 = tuple[float, float, float]
NETWORK, RADIUS = DiscNetwork.packaged(), 22.0
LIMITS = NetworkFollowParameters(rounds=5, still=0.3)
HOPELESS = NetworkFollowParameters(rounds=5, still=0.3, hopeless=-2.0)
STARTS = [(166.0, 117.0, 19.0), (60.0, 60.0, 20.0), (150.0, 128.0, 26.0), (900.0, 50.0, 20.0), (160.0, 120.0, 22.0)]
"""Near the ball, far from it, near, outside of the picture, at it."""


class Led:
    """What a start led to, in the twin."""

    def __init__(self, start: Circle3, limits: NetworkFollowParameters) -> None:
        self.circle, self.looks = np.array(start), 0
        self.found: Disc | None = None
        self.done, self.promise = start[2] < limits.least_radius, -math.inf

    def look(self, image: Picture, limits: NetworkFollowParameters) -> None:
        """Look once and go on."""
        self.looks += 1
        patch = read_patch(image, (self.circle[0], self.circle[1], self.circle[2]))
        seen = None if patch is None else NETWORK.see(patch)
        if seen is None or (self.looks == 1 and seen.log_odds < limits.hopeless):
            self.found, self.done = None, True
            return
        scale = self.circle[2]
        self.circle = self.circle + np.clip(seen.step, -limits.most_step, limits.most_step) * scale
        x, y, radius = self.circle.tolist()
        self.found = Disc((x, y, radius), seen.precision / scale**2, seen.log_odds)
        squared = float(seen.step @ seen.precision @ seen.step)
        self.done = squared < limits.still
        self.promise = seen.log_odds + limits.unrest * math.log(max(squared, limits.still))
        if radius < limits.least_radius:
            self.found, self.done = None, True


def naive_lead(
    image: Picture, starts: list[Circle3], limits: NetworkFollowParameters, looks: int
) -> tuple[list[Disc | None], int]:
    """Each start once, in their order, then the most promising of those that have not arrived."""
    led, taken = [Led(start, limits) for start in starts], 0
    while taken < looks:
        left = [each for each in led if not each.done and each.looks < limits.rounds]
        if not left:
            break
        new = [each for each in left if each.looks == 0]
        (new[0] if new else max(left, key=lambda each: each.promise)).look(image, limits)
        taken += 1
    return [each.found for each in led], taken


def assert_same(one: list[Disc | None], other: list[Disc | None]) -> None:
    assert [each is None for each in one] == [each is None for each in other]
    for found, expected in zip(one, other, strict=True):
        if found is not None and expected is not None:
            assert found.circle == pytest.approx(expected.circle, abs=1e-6)
            assert found.precision == pytest.approx(expected.precision, rel=1e-6, abs=1e-9)
            assert found.log_odds == pytest.approx(expected.log_odds, abs=1e-6)


@pytest.mark.parametrize("limits", [LIMITS, HOPELESS], ids=["all", "hopeless"])
@pytest.mark.parametrize("looks", [0, 1, 2, 4, 5, 6, 7, 9, 12, 1000])
def test_it_is_led_as_its_slow_twin_is(looks: int, limits: NetworkFollowParameters) -> None:
    image = scene(RADIUS)
    discs, taken = NETWORK.lead(image, STARTS, limits, looks=looks)
    expected, expected_taken = naive_lead(image, STARTS, limits, looks)
    assert taken == expected_taken <= looks
    assert_same(discs, expected)


def test_each_start_is_looked_at_once_before_any_is_led_on() -> None:
    image, once = scene(RADIUS), NetworkFollowParameters(rounds=1)
    alone = [NETWORK.follow(image, start, once) for start in STARTS]
    for looks in range(len(STARTS) + 1):
        discs, taken = NETWORK.lead(image, STARTS, LIMITS, looks=looks)
        assert taken == looks
        assert_same(discs, [each if k < looks else None for k, each in enumerate(alone)])


def test_the_looks_that_are_left_go_to_the_likeliest() -> None:
    image = scene(RADIUS)
    starts = [*STARTS[:2], (148.0, 130.0, 27.0)]
    first = NETWORK.lead(image, starts, LIMITS, looks=3)[0]
    after = NETWORK.lead(image, starts, LIMITS, looks=4)[0]
    odds = [-math.inf if each is None else each.log_odds for each in first]
    arrived = [NETWORK.lead(image, [start], LIMITS)[1] == 1 for start in starts]
    likeliest = max((k for k in range(3) if not arrived[k]), key=lambda k: odds[k])
    changed = [k for k, (one, other) in enumerate(zip(first, after, strict=True)) if _moved(one, other)]
    assert changed == [likeliest]


def _moved(one: Disc | None, other: Disc | None) -> bool:
    return one is not None and other is not None and one.circle != other.circle


def test_the_same_is_found_again_in_any_thread_and_each_start_alone_with_looks_enough() -> None:
    image, results = scene(RADIUS), list[list[Disc | None]]()
    workers = [
        threading.Thread(target=lambda: results.append(NETWORK.lead(image, STARTS, LIMITS, looks=9)[0]))
        for _ in range(3)
    ]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join()
    results.append(NETWORK.lead(image, STARTS, LIMITS, looks=9)[0])
    circles = [[None if each is None else each.circle for each in result] for result in results]
    assert all(each == circles[0] for each in circles)
    together = NETWORK.lead(image, STARTS, LIMITS)[0]
    alone = [NETWORK.follow(image, start, LIMITS) for start in STARTS]
    assert [each and each.circle for each in together] == [each and each.circle for each in alone]


def test_nothing_is_led_from_nowhere() -> None:
    image = scene(RADIUS)
    assert NETWORK.lead(image, [], LIMITS) == ([], 0)
    assert NETWORK.lead(image, [(160.0, 120.0, 1.0), (160.0, 120.0, math.nan)], LIMITS) == ([None, None], 0)

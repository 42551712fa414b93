"""The filters of several targets against one filter at a time, and what they expect."""

import math

import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms
from matchset.tracking.many.motion_bank import BALLISTIC, HALTED, STEADY, ManyMotionParameters, MotionBank, Predicted
from matchset.tracking.many.sightings import Sighting
from matchset.tracking.motion import Gate

Floats = npt.NDArray[np.float64]
LIMITS = ManyMotionParameters()
VARIANCE = 0.7**2


def sighting(x: float, y: float, radius: float = 20.0) -> Sighting:
    circle = ms.Circle(x, y, radius)
    track = ms.Track(circle, 0.01 * np.eye(3), 1.0, np.zeros((0, 2)), 0.0)
    return Sighting(track, Gate(x, y, radius), VARIANCE, "0")


class OneFilter:
    """One Kalman filter of one model, as textbooks have it: the slow twin."""

    def __init__(self, model: int, x: float, y: float, radius: float) -> None:
        self.model, self.time, self.size = model, 0.0, math.log(radius)
        self.state = np.array(((x, y), (0.0, 0.0), (0.0, 0.0)))
        sigmas = (LIMITS.center_sigma_px + LIMITS.center_sigma * radius, LIMITS.start_speed * radius)
        last = LIMITS.start_acceleration * radius if model == BALLISTIC else 0.0
        self.covariance = np.diag(np.square((*sigmas, last)))

    def ahead(self, time: float) -> tuple[Floats, Floats]:
        t, size = time - self.time, math.exp(self.size)
        f = np.array(((1.0, t, t * t / 2 if self.model == BALLISTIC else 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0)))
        noise = LIMITS.acceleration * size * np.array((t * t / 2, t, 0.0))
        if self.model == BALLISTIC:
            f[1, 2] = t
            noise = LIMITS.jerk * size * np.array((t**3 / 6, t * t / 2, t))
        return f @ self.state, f @ self.covariance @ f.T + np.outer(noise, noise)

    def correct(self, place: Gate, time: float) -> None:
        x, y, radius = place
        state, covariance = self.ahead(time)
        h = np.array((1.0, 0.0, 0.0))
        gain = covariance @ h / (h @ covariance @ h + VARIANCE)
        self.state = state + np.outer(gain, np.array((x, y)) - state[0])
        self.covariance = covariance - np.outer(gain, h @ covariance)
        self.size += LIMITS.size_gain * (math.log(radius) - self.size)
        self.time = time


@pytest.mark.parametrize("model", [STEADY, BALLISTIC])
def test_all_filters_at_once_are_the_same_as_one_after_the_other(model: int) -> None:
    random = np.random.default_rng(5)
    bank = MotionBank(2, LIMITS)
    begun = random.uniform(20.0, 300.0, (3, 2))
    slots = [bank.begin(Gate(x, y, 20.0), 0.0) for x, y in begun.tolist()]
    twins = [OneFilter(model, x, y, 20.0) for x, y in begun.tolist()]
    for step in range(1, 9):
        time = step / 30.0 + 0.01 * random.random()
        seen = [k for k in range(3) if (step + k) % 3]
        centers = (begun + 6.0 * step + random.normal(0.0, 0.5, (3, 2))).tolist()
        places = {k: Gate(centers[k][0], centers[k][1], 20.0 + k) for k in seen}
        bank.correct([slots[k] for k in seen], [sighting(*places[k]) for k in seen], time)
        for k in seen:
            twins[k].correct(places[k], time)
        tables = bank.tables(time + 0.05)
        for slot, twin in zip(slots, twins, strict=True):
            state, covariance = twin.ahead(time + 0.05)
            assert tables.centers[slot, model] == pytest.approx(state[0])
            assert tables.velocities[slot, model] == pytest.approx(state[1])
            assert tables.variances[slot, model] == pytest.approx(covariance[0, 0])
            assert tables.half_widths[slot] == pytest.approx(math.exp(twin.size))


def thrown(bank: MotionBank, frames: int) -> int:
    slot = bank.begin(Gate(100.0, 300.0, 20.0), 0.0)
    for k in range(1, frames):
        t = k / 30.0
        bank.correct([slot], [sighting(100.0 + 60.0 * t, 300.0 - 600.0 * t + 0.5 * 1400.0 * t * t)], t)
    return slot


def test_a_thrown_ball_is_expected_on_its_parabola() -> None:
    bank = MotionBank(4, LIMITS)
    slot = thrown(bank, 16)
    t = 15 / 30.0 + 0.2
    place, (_, vy) = Predicted(bank, t).likeliest(slot)
    assert place.x == pytest.approx(100.0 + 60.0 * t, abs=4.0)
    assert place.y == pytest.approx(300.0 - 600.0 * t + 0.5 * 1400.0 * t * t, abs=6.0)
    assert vy == pytest.approx(-600.0 + 1400.0 * t, abs=60.0)


def test_what_is_not_seen_for_long_may_have_halted() -> None:
    bank = MotionBank(4, LIMITS)
    slot = thrown(bank, 16)
    last = 15 / 30.0
    where = bank.tables(last).centers[slot, STEADY]
    soon, later = bank.tables(last + 1.0 / 30.0), bank.tables(last + 1.0)
    assert later.centers[slot, HALTED] == pytest.approx(where, abs=3.0)
    assert soon.log_weights[slot, HALTED] < -3.0 < later.log_weights[slot, HALTED]
    near = Predicted(bank, last + 1.0).likelihood(slot, Gate(float(where[0]), float(where[1]), 20.0), VARIANCE)
    assert near.halted
    assert near.squared < 1.0


def test_a_sighting_where_it_is_expected_is_likelier_than_one_elsewhere_or_of_another_size() -> None:
    bank = MotionBank(4, LIMITS)
    slot = bank.begin(Gate(100.0, 100.0, 20.0), 0.0)
    for k in range(1, 6):
        bank.correct([slot], [sighting(100.0 + 3.0 * k, 100.0)], k / 30.0)
    predicted = Predicted(bank, 0.2)
    there = predicted.likelihood(slot, Gate(118.0, 100.0, 20.0), VARIANCE)
    elsewhere = predicted.likelihood(slot, Gate(128.0, 100.0, 20.0), VARIANCE)
    larger = predicted.likelihood(slot, Gate(118.0, 100.0, 26.0), VARIANCE)
    assert there.log > elsewhere.log + 3.0
    assert there.log > larger.log + 3.0
    assert there.squared < 1.0 < min(elsewhere.squared, larger.squared)


def test_slots_are_taken_back_and_as_many_as_are_asked_for() -> None:
    bank = MotionBank(2, LIMITS)
    slots = [bank.begin(Gate(10.0 * k, 5.0, 8.0), 0.0) for k in range(5)]
    assert len(set(slots)) == 5
    bank.free(slots[1])
    copied = bank.copied(slots[4])
    assert copied == slots[1]
    assert Predicted(bank, 0.0).likeliest(copied)[0] == Predicted(bank, 0.0).likeliest(slots[4])[0]


def test_sightings_that_were_only_noted_count_before_anything_is_predicted() -> None:
    bank, other = MotionBank(2, LIMITS), MotionBank(2, LIMITS)
    slot, twin = (each.begin(Gate(50.0, 50.0, 10.0), 0.0) for each in (bank, other))
    bank.note([slot], [sighting(55.0, 50.0, 10.0)], 0.1)
    other.correct([twin], [sighting(55.0, 50.0, 10.0)], 0.1)
    assert Predicted(bank, 0.2).likeliest(slot) == Predicted(other, 0.2).likeliest(twin)

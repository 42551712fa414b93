"""Balls on a table: the law of impact, who touches whom, and names of balls that hit each other."""

import math

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.tracking.many.motion_bank import ManyMotionParameters, MotionBank, Predicted
from matchset.tracking.many.sightings import Sighting
from matchset.tracking.many.table import Rolling, TableParameters, after_impact, friction_of, hits
from matchset.tracking.motion import Gate

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

IDEAL = TableParameters(friction=0.0, restitution=1.0)
speeds = st.floats(-1000.0, 1000.0)
pairs = st.tuples(speeds, speeds, speeds, speeds).map(lambda each: np.array(each).reshape(2, 2))
normals = st.floats(0.0, 2.0 * math.pi).map(lambda angle: np.array((math.cos(angle), math.sin(angle))))
shares = st.floats(0.0, 1.0)


def rolling(
    places: list[tuple[float, float]], velocities: list[tuple[float, float]], variance: float = 0.01
) -> Rolling:
    same = np.full(len(places), variance)
    return Rolling(np.array(places), np.array(velocities), np.full(len(places), 10.0), same, 10.0 * same)


@given(pairs, normals, shares)
def test_an_impact_keeps_the_momentum_and_never_adds_energy(velocities: Floats, normal: Floats, e: float) -> None:
    after = after_impact(velocities, normal, e)
    assert after.sum(axis=0) == pytest.approx(velocities.sum(axis=0), abs=1e-8)
    assert (after**2).sum() <= (velocities**2).sum() * (1.0 + 1e-12) + 1e-9


@given(pairs, normals)
def test_an_ideal_impact_keeps_the_energy(velocities: Floats, normal: Floats) -> None:
    assert (after_impact(velocities, normal, 1.0) ** 2).sum() == pytest.approx((velocities**2).sum(), abs=1e-6)


@given(pairs, normals, shares)
def test_who_is_called_the_first_does_not_matter(velocities: Floats, normal: Floats, e: float) -> None:
    swapped = after_impact(velocities[::-1], -normal, e)[::-1]
    assert swapped == pytest.approx(after_impact(velocities, normal, e), abs=1e-8)


@given(pairs, normals, shares)
def test_two_that_touched_part_with_that_share_of_the_closing_speed(
    velocities: Floats, normal: Floats, e: float
) -> None:
    closing = float((velocities[0] - velocities[1]) @ normal)
    after = after_impact(velocities, normal, e)
    parting = float((after[1] - after[0]) @ normal)
    assert parting == pytest.approx(e * closing if closing > 0.0 else -closing, abs=1e-8)


def test_a_ball_that_hits_one_at_rest_stops_and_the_other_goes_on() -> None:
    found = hits(rolling([(0.0, 0.0), (50.0, 0.0)], [(300.0, 0.0), (0.0, 0.0)]), 0.2, IDEAL)
    assert found[0].place == pytest.approx((30.0, 0.0))
    assert found[0].velocity == pytest.approx((0.0, 0.0))
    assert found[1].place == pytest.approx((80.0, 0.0))
    assert found[1].velocity == pytest.approx((300.0, 0.0))
    assert found[1].since == pytest.approx(0.1)
    assert found[1].share > 0.99


def test_a_row_of_balls_hands_the_impact_on_to_the_last() -> None:
    row = [(0.0, 0.0), *((50.0 + 20.0 * k, 0.0) for k in range(4))]
    found = hits(rolling(row, [(300.0, 0.0), *[(0.0, 0.0)] * 4]), 0.2, IDEAL)
    assert [round(found[k].velocity[0]) for k in range(5)] == [0, 0, 0, 0, 300]


def test_balls_that_pass_each_other_or_part_do_not_hit() -> None:
    assert hits(rolling([(0.0, 0.0), (50.0, 21.0)], [(300.0, 0.0), (0.0, 0.0)]), 0.3, IDEAL) == {}
    assert hits(rolling([(0.0, 0.0), (19.0, 0.0)], [(-300.0, 0.0), (0.0, 0.0)]), 0.3, IDEAL) == {}
    assert hits(rolling([(0.0, 0.0)], [(300.0, 0.0)]), 0.3, IDEAL) == {}


def test_a_graze_is_less_certain_than_a_full_hit() -> None:
    full, graze = (
        hits(rolling([(0.0, 0.0), (50.0, y)], [(300.0, 0.0), (0.0, 0.0)], 4.0), 0.2, IDEAL) for y in (0.0, 19.0)
    )
    assert graze[1].share < full[1].share
    assert graze[1].variance > 0.0
    assert full[1].variance > 4.0


@given(st.floats(0.001, 3.0), st.floats(0.001, 3.0), st.just(0.0) | st.floats(0.001, 5.0))
def test_friction_in_two_steps_is_friction_in_one(first: float, second: float, friction: float) -> None:
    (one, left), (other, later), (both, least) = (
        friction_of(np.array(each), friction) for each in (first, second, first + second)
    )
    assert one + left * other == pytest.approx(float(both))
    assert left * later == pytest.approx(float(least))


def odds_of_right_names(table: TableParameters | None) -> float:
    """Log-odds of the right names against exchanged ones, after two have run into each other between two pictures."""
    bank = MotionBank(4, ManyMotionParameters(table=table))
    slots = [bank.begin(Gate(x, 50.0, 10.0), 0.0) for x in (0.0, 390.0)]
    for t in (0.1, 0.2, 0.3):
        bank.correct(slots, [seen_at(600.0 * t), seen_at(390.0 - 600.0 * t)], t)
    bank.foresee([[slot] for slot in slots], 0.4)
    predicted, after = Predicted(bank, 0.4), (130.0, 260.0)
    one, other = (
        [predicted.likelihood(slot, Gate(x, 50.0, 10.0), 1.0).log for slot, x in zip(slots, places, strict=True)]
        for places in (after, after[::-1])
    )
    return sum(one) - sum(other)


def seen_at(x: float) -> Sighting:
    track = ms.Track(ms.Circle(x, 50.0, 10.0), 0.01 * np.eye(3), 1.0, np.zeros((0, 2)), 0.0)
    return Sighting(track, Gate(x, 50.0, 10.0), 1.0, "0")


def test_the_right_names_are_likelier_after_an_impact_and_without_the_table_the_wrong_ones() -> None:
    assert odds_of_right_names(TableParameters()) > 5.0
    assert odds_of_right_names(None) < 0.0


def drawn(places: list[tuple[float, float]]) -> Bytes:
    rows, columns = np.indices((240, 480))
    image = np.full((240, 480, 3), (90, 120, 90), np.uint8)
    for x, y in places:
        cover = np.clip(14.5 - np.hypot(columns - x, rows - y), 0.0, 1.0)[:, :, None]
        image = np.round(image * (1.0 - cover) + np.array((200, 60, 30)) * cover).astype(np.uint8)
    return image


def course(frames: int, fps: float, speed: float) -> list[list[tuple[float, float]]]:
    """One rolls to the right and hits one at rest, fully: it stops, and the other one goes on."""
    met = (280.0 - 28.0 - 40.0) / speed
    return [
        [(40.0 + speed * min(t, met), 120.0), (280.0 + speed * max(t - met, 0.0), 120.0)]
        for t in (k / fps for k in range(frames))
    ]


@pytest.mark.parametrize("speed", [330.0, 420.0])
def test_names_are_right_after_an_impact_between_two_pictures(speed: float) -> None:
    truth = course(9, 10.0, speed)
    tracker = ms.MultiTracker(ms.Circle, ms.ColorModel.pick(drawn(truth[0]), *truth[0][0]), fps=10.0, on_table=True)
    called = [
        [round(each.track.shape.x) for each in tracker.update(drawn(places)) if isinstance(each.track, ms.Track)]
        for places in truth
    ]
    names = [0, 1] if called[1] == sorted(called[1]) else [1, 0]
    assert called[1] == [round(truth[1][k][0]) for k in names]
    assert called[-1] == [round(truth[-1][k][0]) for k in names]


def test_without_the_table_nothing_of_it_is_used() -> None:
    assert ms.MultiTracker(ms.Circle, ms.ColorModel.pick(drawn([(60.0, 60.0)]), 60, 60)).parameters.motion.table is None

"""Gains are lowered where margins or swings ask for it, and nowhere else; it is said."""

import math

import msgspec
import numpy as np
import pytest

from matchset.control.chain.gain_schedule import Gains, GainScheduleParameters, interpolated
from matchset.control.follower import FollowerParameters
from matchset.control.safety import DesiredCommand
from matchset.control.stability.follower_loops import LoopParameters, lowered
from matchset.control.stability.gain_limit import GainLimit, StabilityParameters
from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.config import with_world
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.report.gain_notes import GainNotes
from matchset.flight.simulate.variation import changed

FOLLOWER = FollowerParameters()
STEP = 1.0 / 30.0
FILTER_GAINS = np.array(((0.67, 2.5, 4.7, -0.3, 0.1), (0.23, 0.82, 1.2, 0.0, 0.0), (1.3, 5.7, 14.4, -0.8, -0.3)))


def limit(follower: FollowerParameters = FOLLOWER) -> GainLimit:
    loops = LoopParameters(*(getattr(follower, name) for name in LoopParameters._fields))
    return GainLimit(loops, follower.stability)


def high_gains(factor: float = 1.0) -> Gains:
    """The high gains, all of the level ones times a factor."""
    low = Gains(FOLLOWER.horizontal, FOLLOWER.horizontal_feedforward, FOLLOWER.vertical_feedforward)
    high = GainScheduleParameters(proportional=7.0 * factor, derivative=4.5 * factor)
    return interpolated(low, high, 1.0)


def checked(gains: Gains, age: float = 0.067, follower: FollowerParameters = FOLLOWER) -> GainLimit:
    """Fly straight for 5 s with these gains."""
    found = limit(follower)
    for _ in range(150):
        found.note_filter(FILTER_GAINS, age, STEP)
        found.note_sticks(DesiredCommand(0.0, 0.0, 0.0, 0.5), 1.0, 0.0, STEP, 10.0)
        found.check(gains, 0.03, 0.02, STEP)
    return found


def swung(found: GainLimit, seconds: float, stick: int = 0, size: float = 1.0) -> None:
    """Let one stick swing from stop to stop."""
    for k in range(round(seconds / STEP)):
        sticks = [0.0] * 4
        sticks[stick] = size * math.sin(9.0 * k * STEP)
        found.note_sticks(DesiredCommand(*sticks), 1.0, k * STEP, STEP, 10.0)


def margins_known(found: GainLimit) -> list[tuple[float, float]]:
    """Margins of all loops, which must be known."""
    known = [each for each in found.state.margins if each is not None]
    assert len(known) == len(found.state.margins)
    return known


def test_gains_that_keep_their_margins_are_the_same_object() -> None:
    found = checked(high_gains())
    assert found.state.factors == (1.0, 1.0, 1.0)
    assert found.state.words == ""
    assert found.horizontal(FOLLOWER.horizontal) is FOLLOWER.horizontal
    (level, phase), (_, rise), (yaw, _) = margins_known(found)
    assert level > 6.0
    assert yaw > 6.0
    assert min(phase, rise) > 40.0


def test_gains_without_margin_are_lowered_until_they_have_it() -> None:
    found = checked(high_gains(4.0), age=0.133)
    factor = found.state.factors[0]
    assert 0.2 < factor < 0.9
    gain, phase = margins_known(found)[0]
    assert gain >= 6.0
    assert phase >= 40.0
    assert found.state.words == f"too little margin of the level loop: gains lowered to {100.0 * factor:.0f} %"
    assert found.horizontal(FOLLOWER.horizontal).derivative == pytest.approx(factor * FOLLOWER.horizontal.derivative)
    assert checked(high_gains(4.0), age=0.067).state.factors[0] > factor  # more delay, less gain


def test_pictures_after_a_gap_do_not_count() -> None:
    found, again = checked(high_gains()), checked(high_gains())
    for _ in range(30):
        found.check(high_gains(), 0.03, 0.02, STEP)
        found.note_filter(3.0 * FILTER_GAINS, 0.067, 0.2)
        again.check(high_gains(), 0.03, 0.02, STEP)
    assert found.state == again.state


def test_where_no_factor_keeps_the_margins_the_gains_stay() -> None:
    steady = msgspec.structs.replace(FOLLOWER.stability, gain_margin_db=200.0)
    found = checked(high_gains(), follower=msgspec.structs.replace(FOLLOWER, stability=steady))
    assert found.state.factors == (1.0, 1.0, 1.0)
    gain, _ = margins_known(found)[0]
    assert 6.0 < gain < 200.0


def test_more_margin_asked_for_is_less_gain() -> None:
    steady = msgspec.structs.replace(FOLLOWER.stability, gain_margin_db=20.0)
    assert checked(high_gains(), follower=msgspec.structs.replace(FOLLOWER, stability=steady)).state.factors[0] < 1.0


def test_a_swing_lowers_its_loop_which_slowly_recovers() -> None:
    found = limit()
    swung(found, 1.3)
    assert found.state.factors[0] == pytest.approx(0.7, abs=0.01)
    assert found.state.factors[1:] == (1.0, 1.0)
    assert found.state.words == "swings to the side: gains lowered to 70 %"
    for k in range(round(50.0 / STEP)):
        found.note_sticks(DesiredCommand(0.0, 0.0, 0.0, 0.5), 1.0, 1.0 + k * STEP, STEP, 10.0)
    assert found.state.factors[0] == 1.0
    assert found.state.words == ""


def test_swings_lower_no_further_than_the_least_factor() -> None:
    found = limit()
    swung(found, 10.0)
    assert found.state.factors[0] == pytest.approx(FOLLOWER.stability.min_factor, abs=0.02)


@pytest.mark.parametrize(("stick", "loop", "words"), [(1, 0, "to and fro"), (2, 2, "in yaw"), (3, 1, "up and down")])
def test_every_stick_has_its_loop_and_its_words(stick: int, loop: int, words: str) -> None:
    found = limit()
    swung(found, 1.3, stick)
    assert found.state.factors[loop] < 1.0
    assert found.state.words.startswith(f"swings {words}: ")


def test_nothing_is_noticed_in_the_first_seconds_nor_where_it_is_not_used() -> None:
    found = limit()
    for k in range(90):
        found.note_sticks(DesiredCommand(math.sin(9.0 * k * STEP), 0.0, 0.0, 0.5), 1.0, k * STEP, STEP, k * STEP)
    assert found.state.factors[0] == 1.0
    off = msgspec.structs.replace(FOLLOWER, stability=StabilityParameters(enabled=False))
    found = checked(high_gains(6.0), follower=off)
    swung(found, 2.0)
    assert found.state.factors == (1.0, 1.0, 1.0)
    assert found.state.margins[0] is None


def test_lowering_takes_all_terms_by_the_same_factor() -> None:
    found = lowered(FOLLOWER.horizontal, 0.5)
    assert (found.proportional, found.integral, found.derivative) == (2.0, 1.05, 1.65)
    assert found.output_limit == FOLLOWER.horizontal.output_limit


@pytest.mark.parametrize(
    "changes", [{"swing_count": 1}, {"lowering_factor": 1.5}, {"min_factor": 0.0}, {"period": 0.0}]
)
def test_parameters_that_make_no_sense_are_refused(changes: dict[str, float]) -> None:
    with pytest.raises(ValueError, match=next(iter(changes))):
        msgspec.structs.replace(StabilityParameters(), **changes)


def flown(factor: float, used: bool = True) -> list[ChainStep]:
    """A chain whose vehicles tilt a quarter more than told, its level gains times a factor: 15 s without pictures."""
    flight, replace = with_world(FlightParameters(duration=15.0), seed=145, quick=True), msgspec.structs.replace
    follower = flight.pilot.follower
    level, schedule = follower.horizontal, follower.gain_schedule
    follower = replace(
        follower,
        horizontal=replace(level, proportional=factor * level.proportional, derivative=factor * level.derivative),
        gain_schedule=replace(
            schedule, proportional=factor * schedule.proportional, derivative=factor * schedule.derivative
        ),
        stability=replace(follower.stability, enabled=used),
    )
    flight = replace(flight, pilot=replace(flight.pilot, follower=follower))
    with Flight(changed(flight, {"full_tilt": 1.25})) as chain:
        return list(chain)


def spread(steps: list[ChainStep]) -> float:
    """Largest rms off the set place in the second half, m."""
    late = np.array([step.true_positions - (0.0, -0.19, 1.5) for step in steps[len(steps) // 2 :]])
    return float(np.sqrt((late**2).mean(axis=0)).max())


def test_a_chain_with_gains_half_as_high_again_is_damped_and_says_so() -> None:
    with_limit, without = flown(1.5), flown(1.5, used=False)
    assert spread(with_limit) < 0.7 * spread(without)
    notes = GainNotes(2)
    for step in with_limit:
        notes.add(step.time, step.steps)
    assert any("swings to the side: gains lowered to 70 %" in line for line in notes.lines())
    assert "level" in notes.margins_text(0)
    assert not any(step.steps[0].control and step.steps[0].control.gains.words for step in without)

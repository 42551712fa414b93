"""Flights without pictures: the same loop by outlines, and what the simulated side alone may differ in."""

import itertools
import math
from typing import Any

import pytest

from matchset.control.command import Command
from matchset.flight.chain.config import with_conditions, with_uri
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.simulate.flights import fly_once
from matchset.links.simulated import SimulatedChain
from matchset.links.simulation_parameters import SimulationParameters
from matchset.localization.pose import Pose
from matchset.sim.conditions.conditions import Conditions


def quick(duration: float = 8.0, world: dict[str, object] | None = None, **named: Any) -> FlightParameters:
    settings = SimulationParameters(vehicles=2, seed=3, quick=True, **(world or {}))  # type: ignore[arg-type]
    return with_conditions(FlightParameters(duration=duration, world=settings), **named)


def test_a_follower_holds_its_place_by_outlines() -> None:
    score = fly_once(quick(12.0))
    assert score.survived
    assert score.worst_spread < 0.08
    assert min(score.found) > 0.99


def test_the_same_seed_is_the_same_flight_and_nobody_tells_the_follower() -> None:
    one, two, weak = (fly_once(quick(4.0, thrust=thrust)) for thrust in (1.0, 1.0, 0.6))
    assert (one.spread, one.end) == (two.spread, two.end)
    assert one.survived
    assert "floor" in weak.crash  # 0.59 of the throttle does not carry it


def test_pictures_that_stand_still_end_a_flight_without_pictures_too() -> None:
    score = fly_once(quick(5.0, world={"freeze": 2.0}))
    assert "stands still" in score.landing_reason
    assert score.descent_time == pytest.approx(2.2, abs=0.2)


def test_a_hidden_ball_is_not_found() -> None:
    with Flight(quick(3.5, world={"hidden": 0.3, "hidden_every": 2.0})) as flight:
        found = [isinstance(step.steps[0].pose, Pose) for step in flight]
    assert 0.6 < sum(found) / len(found) < 0.97


def stamps(count: int = 60, **named: float) -> tuple[list[float], list[float]]:
    """Stamps of the pictures that came, and when they were delivered."""
    world = SimulationParameters(vehicles=2, quick=True, latency_ms=133.0, conditions=Conditions(**named))
    chain = SimulatedChain(world)
    times, arrivals = [], []
    for _ in range(count):
        if (frame := chain.cameras[0].read()) is not None:
            times.append(frame.time)
            arrivals.append(chain.now())
    chain.close()
    return times, arrivals


def test_pictures_are_later_than_their_stamps_say() -> None:
    times, arrivals = stamps(told_latency_ms=67.0)
    assert [b - a for a, b in zip(times, arrivals, strict=True)] == pytest.approx([0.067] * 60, abs=1.0 / 480.0)
    assert times[0] == pytest.approx(1.0 / 30.0 + 0.066)


def test_pictures_jitter_and_never_overtake_each_other() -> None:
    times, arrivals = stamps(jitter_ms=40.0)
    lags = [b - a for a, b in itertools.pairwise(times)]
    assert min(lags) > 0.0
    assert max(lags) > 0.05
    assert min(b - a for a, b in itertools.pairwise(arrivals)) >= 0.0
    assert [b - a for a, b in zip(times, arrivals, strict=True)] == pytest.approx([0.133] * 60, abs=1.0 / 480.0)


def test_a_share_of_pictures_and_commands_is_lost() -> None:
    times, _ = stamps(200, frames_lost=0.3)
    assert len(times) / 200 == pytest.approx(0.7, abs=0.1)
    chain = SimulatedChain(SimulationParameters(vehicles=2, quick=True, conditions=Conditions(commands_lost=1.0)))
    link = chain.links[0]
    link.arm()
    for _ in range(30):
        chain.cameras[0].read()
        link.send(Command(throttle=0.7))
    assert chain.world.motion.held[0] == 1  # nothing arrived
    chain.close()


def test_a_uri_names_conditions_and_a_flight_that_is_shown_has_pictures() -> None:
    flight = with_uri("sim://chain?thrust=0.9&gust_m_s=0.5&seed=4", FlightParameters())
    assert flight.world.conditions == Conditions(thrust=0.9, gust_m_s=0.5)
    assert flight.world.seed == 4
    for wrong, words in (("thrust=9", "thrust"), ("quick=true", "quick"), ("wind_m_s=nan", "wind_m_s")):
        with pytest.raises(ValueError, match=words):
            with_uri(f"sim://chain?{wrong}", FlightParameters())
    with pytest.raises(ValueError, match="thrust"):
        with_conditions(FlightParameters(), thrust=math.nan)

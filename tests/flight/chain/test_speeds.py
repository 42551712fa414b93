"""A chain of vehicles that are told speeds, without pictures; settings; what is refused."""

import msgspec
import pytest

from blue_ball import Matchset
from matchset.flight.chain.config import with_uri, with_world
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore, FlightScorer


def flown(seed: int, duration: float = 12.0, **world: float | str) -> tuple[FlightScore, Flight]:
    parameters = msgspec.structs.replace(
        with_world(FlightParameters(), quick=True, commands="speeds", seed=seed, **world), duration=duration
    )
    scorer = FlightScorer(parameters)
    with Flight(parameters) as flight:
        for step in flight:
            scorer.add(step)
    return scorer.score(), flight


def test_a_chain_holds_its_place() -> None:
    score, flight = flown(120)
    assert score.survived
    assert score.worst_spread < 0.07
    assert all(pilot._follower.limit.state.words == "" for pilot in flight.pilots)
    assert all(pilot._follower.hover_throttle == 0.5 for pilot in flight.pilots)


def test_one_whose_camera_is_gone_stands_still_sinks_and_lands() -> None:
    score, flight = flown(122, 9.0, cable=5.0)
    assert not score.survived
    for pilot in flight.pilots:
        assert pilot._safety.phase == "cut"
    assert 5.25 < score.descent_time < 5.5


def test_a_ball_that_is_hidden_for_a_while_is_flown_on_without() -> None:
    score, _ = flown(123, 14.0, hidden=0.5, hidden_every=4.0)
    assert score.survived


def test_the_world_decides_what_a_follower_tells() -> None:
    flight = with_uri("sim://chain?commands=speeds", FlightParameters())
    assert flight.loop.follower.commands == "speeds"
    assert flight.loop.follower.ego_motion.speed_commands
    assert not FlightParameters().loop.follower.ego_motion.speed_commands
    assert flight.loop.follower.in_use == flight.loop.follower
    with pytest.raises(ValueError, match="commands"):
        with_uri("sim://chain?commands=rates", FlightParameters())


def test_it_is_not_identified(matchset: Matchset, capsys: pytest.CaptureFixture[str]) -> None:
    assert matchset("identify", "sim://chain?commands=speeds&vehicles=2") == 2
    assert "this one is told speeds" in capsys.readouterr().err

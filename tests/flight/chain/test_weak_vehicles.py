"""Vehicles that become too weak to fly: simulated flights without pictures."""

import itertools

from matchset.flight.chain.config import with_world
from matchset.flight.chain.flight import Flight
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScorer
from matchset.flight.simulate.variation import changed

FASTEST = 2.0  # m/s; one that falls from its place arrives at more than 4


def test_one_whose_battery_ends_is_landed_while_it_can() -> None:
    flight = with_world(FlightParameters(duration=30.0), seed=3, quick=True)
    parameters = changed(flight, {"battery_loss_per_min": 1.0})  # its thrust is its weight after 25 s
    scorer, places = FlightScorer(parameters), []
    with Flight(parameters) as steps:
        for step in steps:
            scorer.add(step)
            if scorer.crashed:
                break
            places.append((step.time, [pose.position[1] for pose in step.truth]))
    score = scorer.score()
    assert "nearly all of the throttle" in score.landing_reason
    assert 15.0 < score.descent_time < 25.0
    fastest = 0.0
    for (before, was), (after, are) in itertools.pairwise(places):
        fastest = max([fastest, *(abs(b - a) / (after - before) for a, b in zip(was, are, strict=True))])
    assert fastest < FASTEST

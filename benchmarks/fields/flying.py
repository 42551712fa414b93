"""A chain in rendered pictures with a long latency, flown by whole frames and by half-frames."""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

from benchmarks.flight.flown import fly_noted
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.links.simulation_parameters import SimulationParameters


class Flights(NamedTuple):
    """What came of a seed.

    Attributes
    ----------
    seed : int
    worst : (float, float)
        Largest root mean square of an axis of a follower, m: by frames, and by half-frames.
    mean : (float, float)
        Mean of the axes, m.
    flown : (bool, bool)
        Whether everyone flew to the end.
    """

    seed: int
    worst: tuple[float, float]
    mean: tuple[float, float]
    flown: tuple[bool, bool]


def fly(seed: int, duration: float, latency_ms: float) -> Flights:
    """Fly a chain of three both ways."""
    kinds: tuple[Literal["frames", "top"], ...] = ("frames", "top")
    scores = [
        fly_noted(
            FlightParameters(
                world=SimulationParameters(seed=seed, latency_ms=latency_ms, fields=fields), duration=duration
            )
        ).score
        for fields in kinds
    ]
    one, other = (np.array(score.spread) for score in scores)
    worst, mean = (float(one.max()), float(other.max())), (float(one.mean()), float(other.mean()))
    return Flights(seed, worst, mean, (scores[0].survived, scores[1].survived))


def ratio(pairs: Sequence[tuple[float, float]]) -> float:
    """Return the median over seeds of what half-frames leave of an error of frames."""
    return float(np.median([half / whole for whole, half in pairs]))

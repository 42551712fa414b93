"""How exactly simulated vehicles hold their places in rendered pictures: `measure`.

Flights of `matchset fly "sim://chain?seed=N"`, 20 s each.
"""

import math
from collections.abc import Sequence

from benchmarks.regression.figures import FLIGHT, NEVER, Figure
from matchset.flight.chain.config import with_uri
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.score import FlightScore
from matchset.flight.simulate.flights import fly_once

SECTION, ALL = "flights", "all"
SEEDS = (*range(900, 910), *range(1000, 1010))
"""Ten that have been looked at, and ten that nothing was tuned on."""
DURATION = 20.0  # s


def flight(seed: int, duration: float = DURATION) -> FlightParameters:
    """Make the flight of a seed, so long, s."""
    return with_uri(f"sim://chain?seed={seed}", FlightParameters(duration=duration))


def worst_axis_cm(score: FlightScore) -> float:
    """Largest root mean square off the set place, of any follower in any axis, cm; not a number if there is none."""
    return 100.0 * score.worst_spread if math.isfinite(score.worst_spread) else math.nan


def measure(seeds: Sequence[int] = SEEDS, duration: float = DURATION) -> list[Figure]:
    """Fly all seeds, one after the other, each so long, s."""
    scores = {seed: fly_once(flight(seed, duration)) for seed in seeds}
    by_seed = [
        Figure.of((SECTION, f"seed {seed}"), "worst axis, cm", worst_axis_cm(score), FLIGHT)
        for seed, score in scores.items()
    ]
    where, every = (SECTION, ALL), [figure.value for figure in by_seed]
    worst = math.nan if any(math.isnan(value) for value in every) else max(every)
    ended = sum(not score.survived for score in scores.values())
    return [
        *by_seed,
        Figure.of(where, "worst axis, cm", worst, FLIGHT),
        Figure.of(where, "ended early", ended, NEVER),
    ]

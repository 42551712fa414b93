"""trackpy's `link`: least squares of displacements, with the velocity of what moves nearest as its prediction."""

import warnings
from collections import deque
from collections.abc import Iterator
from itertools import count
from typing import Any

import pandas
import trackpy

from benchmarks.crowds.peers.peer import Detection, Named, Step

LEAST_RANGE = 1.0  # px: where it is crowded, the range is made less down to it


def start(_: str, parameters: dict[str, Any]) -> Step:
    """Link frame by frame; `span`: frames of which velocities are the mean, 0 for none."""
    trackpy.quiet()
    waiting: deque[pandas.DataFrame] = deque()
    numbers = count()

    def frames() -> Iterator[pandas.DataFrame]:
        while True:
            yield waiting.popleft()

    predict = trackpy.predict
    span = parameters["span"]
    motion = predict.NearestVelocityPredict(span=span) if span else predict.NullPredict()
    linked = motion.link_df_iter(
        frames(),
        parameters["search_range"],
        memory=parameters["memory"],
        adaptive_stop=min(LEAST_RANGE, parameters["search_range"]),
        adaptive_step=0.9,
    )

    def step(found: list[Detection]) -> list[Named]:
        number = next(numbers)
        if not found:  # its prediction cannot do without
            return []
        table = pandas.DataFrame(found, columns=["x", "y", "r", "sure"])
        waiting.append(table.assign(frame=number))
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            row = next(linked)
        names = row.particle.tolist()
        return [(int(name), x, y, r) for name, (x, y, r, _) in zip(names, found, strict=True)]

    return step

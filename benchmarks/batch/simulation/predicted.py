"""Two workers, simulated and real: `predict`."""

import msgspec
import numpy as np

from benchmarks.batch.kept import Kept
from benchmarks.batch.simulation.basis import slowdown
from benchmarks.batch.simulation.simulate import Cluster, Task, simulate

DRAWS = 1000


class Predicted(msgspec.Struct, frozen=True):
    """A run of two workers.

    Parameters
    ----------
    real, simulated : list of float
        Of each round, s.
    low, high : float
        Of 95 % of the runs whose tasks are drawn from all measured ones, s.
    """

    real: list[float]
    simulated: list[float]
    low: float
    high: float

    @property
    def errors(self) -> list[float]:
        """Of each round, %."""
        return [100.0 * (guess / real - 1.0) for guess, real in zip(self.simulated, self.real, strict=True)]

    @property
    def error(self) -> float:
        """Of the medians, %."""
        return 100.0 * (float(np.median(self.simulated)) / float(np.median(self.real)) - 1.0)


def predict(kept: Kept, seed: int = 0) -> Predicted:
    """Simulate the runs of two workers from those of one, and from what two plain processes lose beside each other.

    Nothing of the batch with two workers is used, but to compare.

    Parameters
    ----------
    kept : Kept
        With speed and tasks (ValueError if not).
    seed : int
        Of the draws.
    """
    if kept.speed is None or kept.tasks is None:
        raise ValueError("measure speed and tasks first")
    lost = slowdown(kept)
    cost = next(each.seconds for each in kept.tasks.costs if each.name == "1 processes")
    cluster = Cluster(workers=2, cost=cost, rate=lambda count: 1.0 if count == 1 else 1.0 / lost)
    rounds = [each.batch[0].tasks for each in kept.speed.rounds]
    made = [simulate([Task(seconds) for seconds in each], cluster).seconds for each in rounds]
    every, rng = np.concatenate(rounds), np.random.default_rng(seed)
    draws = rng.choice(every, (DRAWS, len(rounds[0])))
    drawn = [simulate([Task(seconds) for seconds in draw], cluster).seconds for draw in draws.tolist()]
    low, high = np.quantile(drawn, (0.025, 0.975)).tolist()
    return Predicted([each.batch[1].seconds for each in kept.speed.rounds], made, low, high)

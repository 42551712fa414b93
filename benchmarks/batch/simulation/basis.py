"""What the simulation begins with: measured times, sizes and costs, `Basis`, kept in `measured.json`."""

from pathlib import Path

import msgspec
import numpy as np

from benchmarks.batch.kept import Kept
from benchmarks.batch.simulation.simulate import Task
from matchset.image.files.whole_file import write_whole

FILE = Path(__file__).with_name("measured.json")


class Basis(msgspec.Struct, frozen=True):
    """Of one machine.

    Parameters
    ----------
    where : str
        Time, commit and machine.
    seconds : list of float
        Each task with all processors busy, s.
    bytes : list of int
        Its video.
    written : float
        Results of a video, bytes, mean.
    length : list of float
        Of its video, s.
    costs : dict of str to float
        A task of Dask, by the clock, s, by the number of workers.
    """

    where: str
    seconds: list[float]
    bytes: list[int]
    written: float
    length: list[float]
    costs: dict[str, float]

    @classmethod
    def load(cls) -> "Basis":
        """Read what is kept in the repository."""
        return msgspec.json.decode(FILE.read_bytes(), type=cls)

    def save(self) -> None:
        """Keep it in the repository."""
        write_whole(FILE, msgspec.json.format(msgspec.json.encode(self), indent=1) + b"\n")

    @property
    def seconds_a_second(self) -> float:
        """Computing for a second of video, s."""
        return sum(self.seconds) / sum(self.length)

    @property
    def bytes_a_second(self) -> float:
        """Of a second of video."""
        return sum(self.bytes) / sum(self.length)

    def cost(self, workers: int) -> float:
        """Return what a scheduler with so many workers takes for a task, s: by a line through what was measured."""
        counts, seconds = np.array([int(each) for each in self.costs]), np.array(list(self.costs.values()))
        slope, offset = np.polyfit(counts, seconds, 1)
        return float(max(offset, 0.0) + max(slope, 0.0) * workers)

    def draw(self, count: int, length: float | None, rng: np.random.Generator) -> list[Task]:
        """Draw tasks from the measured ones.

        Parameters
        ----------
        count : int
        length : float or None
            Of each video, s; speed and bytes a second are those of the drawn one. None: as measured.
        rng : numpy.random.Generator
        """
        drawn = rng.integers(len(self.seconds), size=count)
        return [self._task(index, length) for index in drawn.tolist()]

    def _task(self, index: int, length: float | None) -> Task:
        factor = 1.0 if length is None else length / self.length[index]
        return Task(factor * self.seconds[index], factor * self.bytes[index], factor * self.written)


def basis_of(kept: Kept, sizes: list[int], lengths: list[float]) -> Basis:
    """Return what was measured, in the form that the simulation takes (ValueError if something is missing).

    Parameters
    ----------
    kept : Kept
    sizes, lengths : list
        Bytes and length, s, of the videos, in their order.
    """
    speed, overhead, tasks = kept.speed, kept.overhead, kept.tasks
    if speed is None or overhead is None or tasks is None:
        raise ValueError("measure speed, overhead and tasks first")
    times = np.median([each.batch[0].tasks for each in speed.rounds], axis=0) * slowdown(kept)
    costs = {str(cost.workers): cost.seconds for cost in tasks.costs if cost.name == "Dask"}
    lengths = [round(length, 3) for length in lengths]
    return Basis(kept.where["speed"], times.round(4).tolist(), sizes, overhead.mean("kept"), lengths, costs)


def slowdown(kept: Kept) -> float:
    """How many times as long a video takes where two processes follow videos, by plain `track`."""
    assert kept.speed is not None
    return 2.0 / kept.speed.median(lambda each: each.machine)

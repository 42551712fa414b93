"""Times of any number of frames in little memory: `Durations` counts them, `FrameTimes` has their four figures."""

import math
import time
from array import array

import msgspec
import numpy as np
import numpy.typing as npt

LEAST, GROWTH, BINS = 1e-6, 1.01, 2084  # format: of the bins: the first one's upper end, s, their ratio; up to 1000 s
PER_FACTOR = 1.0 / math.log(GROWTH)  # geometry: bins in a factor of e
SHOWN_PERIOD = 0.5  # format: s between two summaries for a page: what a person reads; one takes 0.1 ms
SHARE = 0.95  # format: of the frames, within the time that is shown beside median, mean and worst


class FrameTimes(msgspec.Struct, frozen=True):
    """What a frame took, in four figures.

    Parameters
    ----------
    median, mean, percentile_95, worst : float
        s
    """

    median: float
    mean: float
    percentile_95: float
    worst: float

    @property
    def in_ms(self) -> dict[str, float]:
        """The figures by their names, ms, four digits each: for files and pages."""
        return {name: float(f"{1e3 * getattr(self, name):.4g}") for name in self.__struct_fields__}

    @property
    def words(self) -> str:
        """The figures in one short line: ``median 0.15, mean 37.0, 95 % 210, worst 1020 ms``."""
        median, mean, most, worst = (ms_text(getattr(self, name)) for name in self.__struct_fields__)
        return f"median {median}, mean {mean}, 95 % {most}, worst {worst} ms"


def ms_text(seconds: float) -> str:
    """Write a time as a number of ms: three digits, two decimals at most."""
    value = 1e3 * seconds
    return f"{value:.{2 if value < 9.995 else 1 if value < 99.95 else 0}f}"


class Durations:
    """Counts times in bins, each 1 % longer than the one before: 17 kB, however many there are.

    Number, mean and worst are exact. A quantile is the time of one of the frames (`numpy.quantile` with
    ``inverted_cdf``), but for 0.5 % or 1 us, whichever is more; of times above 1000 s it is too small.

    Attributes
    ----------
    count : int
        How many times were added.
    worst : float
        The longest, s; 0 without any.
    """

    def __init__(self) -> None:
        self.count, self.worst = 0, 0.0
        self._least, self._sum = math.inf, 0.0
        self._bins = array("q", bytes(8 * BINS))

    def add(self, seconds: float) -> None:
        """Count a time, s."""
        place = math.ceil(PER_FACTOR * math.log(seconds / LEAST)) if seconds > LEAST else 0
        self._bins[min(place, BINS - 1)] += 1
        self.count += 1
        self._sum += seconds
        self._least, self.worst = min(self._least, seconds), max(self.worst, seconds)

    @property
    def mean(self) -> float:
        """Mean time, s; 0 without any."""
        return self._sum / self.count if self.count else 0.0

    def quantile(self, share: float) -> float:
        """Return the time within which a share of them, 0 ... 1, were, s; 0 without any."""
        counts = np.cumsum(np.array(self._bins, np.int64))
        if not counts[-1]:
            return 0.0
        place = int(np.searchsorted(counts, max(share * float(counts[-1]), 1.0)))
        middle = LEAST * GROWTH ** (place - 0.5) if place else 0.5 * LEAST
        return min(max(middle, self._least), self.worst)

    def times(self) -> FrameTimes | None:
        """Return the four figures; None without any. Another thread may add meanwhile."""
        if not self.count:
            return None
        return FrameTimes(self.quantile(0.5), self.mean, self.quantile(SHARE), self.worst)


class ShownTimes:
    """Counts times for a page, which is told of them twice a second."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Forget all."""
        self._durations, self._shown, self._made = Durations(), dict[str, float](), -math.inf

    def add(self, seconds: float) -> None:
        """Count a time, s."""
        self._durations.add(seconds)

    @property
    def in_ms(self) -> dict[str, float]:
        """The figures so far, or as they were up to half a second ago: see `FrameTimes.in_ms`; empty without any."""
        now = time.monotonic()
        if now - self._made >= SHOWN_PERIOD:
            times, self._made = self._durations.times(), now
            self._shown = {} if times is None else times.in_ms
        return self._shown


def times_of(seconds: npt.NDArray[np.float64]) -> FrameTimes | None:
    """Return the four figures of times that are all at hand, s, exactly; None where none is finite."""
    known = seconds[np.isfinite(seconds)]
    if not len(known):
        return None
    median, most = np.quantile(known, (0.5, SHARE)).tolist()
    return FrameTimes(median, float(known.mean()), most, float(known.max()))

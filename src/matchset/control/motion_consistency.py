"""Whether the motion of the ball answers to the vehicle's own commands, or to those of long ago: `MotionConsistency`.

A vehicle tilts all the time, so the ball moves up and down in its pictures as dead reckoning says; in pictures that are
older than their time stamps it moves as dead reckoning said then. With the row e of the rotation from the camera to the
level frame at rest, the unit vector u to the ball, the vehicle's height h and the mean distance d, the height of the
ball over its distance, if a picture of time t is D older than that, is

    r_D(t) = e(t - D) u(t) + (h(t - D) - h) / d,

and a neighbor changes it slowly, by a straight line in the time t - D. Hypotheses are compared by what is left of the
last r without that line: one delay all the time, a small one; or a large one; or a small one until some picture, and
then a large one or a picture that stands still. What is left is correlated: gusts, and models that are poor, leave much
of it to all hypotheses. So differences of one picture to the next are whitened as those of a random walk with noise on
top, a moving average of first order (Box, Jenkins & Reinsel 2008, section 4.3), and the evidence is

    ln((n noise^2 + s_0) / (n noise^2 + s_1))

with the least sums of squares s_0 of a small delay all the time (the largest square is left out, for one outlier), and
s_1 of the others: the logarithm of the generalized likelihood ratio of n numbers of unknown variance, over n / 2.
"""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.ego_motion import STATE, STATE_SIZE, EgoMotion
from matchset.control.learned.delay import DelayEstimator, DelayEstimatorParameters
from matchset.localization.pose import Pose
from matchset.numeric.arguments import require, require_at_least, require_not_negative, require_positive, require_within
from matchset.numeric.jit import helper, kernel

Floats = npt.NDArray[np.float64]

TINY = 1e-12  # s^2, m and rad^2: least divisor
TIME, DISTANCE, DIRECTION, DELAYS = 0, 1, 2, 5  # format: first columns of a pose: time, distance, direction, delays
ROW, LEVEL, HEIGHT, EACH = 0, 3, 4, 5  # format: for each delay the row e, e u, h; how many these are


class MotionConsistencyParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When pictures are taken to be old.

    Chosen on flights without pictures of seeds 0 to 35 and 100 to 102, with and without pictures that are 0.4 to 0.8 s
    old, with gusts, latencies told wrong and vehicles that differ, and on one of Betaflight:
    docs/log/control.md#old-pictures;
    `python -m benchmarks.flight.faults` shows a change.

    Parameters
    ----------
    window : int
        Differences of poses, one after the other, that are looked at. More tells old pictures from gusts, later.
    min_latency_count, min_evidence_count : int
        Of these, so many suffice after the start to learn a latency, and to know old pictures; their evidence counts as
        their share of `window`.
    min_changed_count : int
        Differences after the change to old pictures, at least: one outlier is none.
    stride : int
        A change is tried at one of so many poses. More is faster (2: 35 us a pose, 4: 15 us), and a little later.
    max_duration : float
        Largest time from the first to the last pose, s; over a longer one nothing is said. Chosen by hand: twice that
        of a full window, so half of the pictures may be missing.
    delay_spacing : float
        From one delay to the next, s. Chosen by hand: one picture.
    min_delay, max_delay : float
        Range of the small delays beyond what was told, s: a latency that was not told is none. More is slower to know
        old pictures.
    min_old_delay, max_old_delay : float
        Range of the large ones, s. What is between `max_delay` and `min_old_delay` is neither.
    moving_average : float
        Coefficient of the moving average, 0 to 1. Less forgives gusts and poor models, more knows old pictures in calm
        flights sooner.
    noise : float
        Standard deviation of what a perfect model leaves, rad: that of a picture.
    max_evidence : float
        Largest evidence with which a vehicle flies on. In flights without fault 1.9 was the largest, in a gust of wind,
        1.5 with Betaflight, and 1.2 in all others.
    confirmations : int
        So many poses in a row must give more than that: in gusts one alone did. More is a picture later each.
    settling_time : float
        Time after the start in which nothing is said of old pictures, s: the vehicle is in a hand or on the ground,
        which its dead reckoning does not know.
    delay_estimator : DelayEstimatorParameters
        Which of the small delays is that of camera and radio.
    """

    window: int = 40
    min_latency_count: int = 8
    min_evidence_count: int = 16
    min_changed_count: int = 3
    stride: int = 4
    max_duration: float = 2.67
    delay_spacing: float = 1.0 / 30.0
    min_delay: float = -1.0 / 30.0
    max_delay: float = 0.2
    min_old_delay: float = 0.4
    max_old_delay: float = 0.8
    moving_average: float = 0.5
    noise: float = 0.001
    max_evidence: float = 1.85
    confirmations: int = 2
    settling_time: float = 0.8
    delay_estimator: DelayEstimatorParameters = DelayEstimatorParameters()

    def __post_init__(self) -> None:
        require_at_least(self, 4, "window", "min_latency_count", "min_evidence_count")
        require(
            self, ("min_latency_count",), lambda value: value <= self.min_evidence_count, "at most min_evidence_count"
        )
        require(self, ("min_evidence_count",), lambda value: value <= self.window, "at most window")
        require(
            self,
            ("min_changed_count",),
            lambda value: 1 <= value <= self.min_evidence_count,
            "within 1 ... min_evidence_count",
        )
        require_at_least(self, 1, "stride", "confirmations")
        require_positive(self, ("max_duration", "delay_spacing", "noise", "max_evidence", "settling_time"))
        require_not_negative(self, ("moving_average", "max_delay"))
        require(self, ("moving_average",), lambda value: value < 1.0, "below 1")
        require_within(self, {"min_delay": (-0.2, 0.0)})
        require(self, ("min_old_delay",), lambda value: value > self.max_delay, "more than max_delay")
        require(
            self, ("max_old_delay",), lambda value: self.min_old_delay <= value <= 1.0, "within min_old_delay ... 1"
        )

    @property
    def delays(self) -> tuple[Floats, Floats]:
        """The small and the large delays, s; 0 is one of the small ones."""
        first, last = (
            math.ceil(self.min_delay / self.delay_spacing - TINY),
            math.floor(self.max_delay / self.delay_spacing + TINY),
        )
        small = self.delay_spacing * np.arange(first, last + 1, dtype=np.float64)
        far = np.arange(
            self.min_old_delay, self.max_old_delay + 0.5 * self.delay_spacing, self.delay_spacing, dtype=np.float64
        )
        return small, far


class MotionConsistency:
    """Compares the seen motion with that commanded now and long ago. The constructor compiles all kernels.

    Parameters
    ----------
    parameters : MotionConsistencyParameters, optional

    Attributes
    ----------
    delays : ndarray of float64
        Those that are compared, s beyond what was told, the small ones first.
    evidence : float
        Of the last update, that pictures are old; 0 while there is none.
    latency : DelayEstimator
        What of the small delays is that of camera and radio beyond what was told.
    """

    def __init__(self, parameters: MotionConsistencyParameters | None = None) -> None:
        self.parameters = parameters or MotionConsistencyParameters()
        small, far = self.parameters.delays
        self.delays = np.concatenate((small, far))
        told = self.parameters
        self._settings = np.array((told.moving_average, told.noise, told.min_changed_count, told.stride))
        self._window = np.zeros((told.window + 1, DELAYS + EACH * len(self.delays)))
        self._scratch = np.zeros((len(self.delays) + 6, told.window + 1))
        self._position, self._left = np.zeros(3), np.zeros(len(small))
        self._times, self._states = np.zeros(len(self.delays)), np.zeros((len(self.delays), STATE_SIZE))
        self.latency = DelayEstimator(small, told.delay_estimator)
        self.reset()
        note_pose(self._window, self._states, self._position, 0.0)
        self._measure(told.window + 1)

    @property
    def is_current(self) -> bool:
        """Whether the pictures may be those of now."""
        return self._against < self.parameters.confirmations

    def reset(self) -> None:
        """Forget everything but the latency: the vehicle does not fly."""
        self._count, self._settled, self._begin, self._time, self.evidence = 0, 0, math.inf, -math.inf, 0.0
        self._against = 0  # poses in a row whose evidence is too large
        self.latency.reset()

    def update(self, pose: Pose, ego: EgoMotion, flies: bool = True) -> None:
        """Note a pose in the camera frame, and where the vehicle was if its picture is older than it says.

        Parameters
        ----------
        pose : Pose
        ego : EgoMotion
            Dead reckoning; it gets the delay that was learned.
        flies : bool
            Whether the thrust suffices for that: if not, nothing is noted.
        """
        parameters, time = self.parameters, pose.time
        self._begin = min(self._begin, time)
        if not flies:
            return
        self._position[:] = pose.position
        ego.write_states(np.subtract(time + self.latency.extra, self.delays, self._times), self._states)
        note_pose(self._window, self._states, self._position, time)
        self._count = min(self._count + 1, parameters.window + 1)
        if time - self._begin >= parameters.settling_time:
            self._settled = min(self._settled + 1, parameters.window + 1)
        settled = self._settled > parameters.min_evidence_count
        count = self._settled if settled else self._count
        known = (
            count > parameters.min_latency_count
            and 0.0 < time - self._window.item(-count, TIME) <= parameters.max_duration
        )
        evidence = self._measure(count) if known else 0.0
        self.evidence = evidence if settled else 0.0
        self._against = self._against + 1 if self.evidence > parameters.max_evidence else 0
        if known and self.evidence <= 0.5 * parameters.max_evidence:  # old pictures are no latency
            self.latency.update(self._left, time - self._time)
            ego.delay = max(ego.parameters.delay + self.latency.extra, 0.0)
        self._time = time

    def _measure(self, count: int) -> float:
        """Evidence of the last so many poses, and what each small delay leaves of their motion."""
        ratio = measure(
            self._window[-count:], self.delays, self.latency.extra, self._settings, self._scratch, self._left
        )
        return float(ratio) * (count - 1) / self.parameters.window


@kernel
def note_pose(window: Floats, states: Floats, position: Floats, time: float) -> None:
    """Append a pose, and forget the first one; the row e is that of Ry(yaw) Rx(-pitch) Rz(roll) that gives down."""
    for j in range(window.shape[0] - 1):
        for k in range(window.shape[1]):
            window[j, k] = window[j + 1, k]
    last = window[window.shape[0] - 1]
    last[TIME] = time
    last[DISTANCE] = max(math.sqrt(position[0] ** 2 + position[1] ** 2 + position[2] ** 2), TINY)
    for k in range(3):
        last[DIRECTION + k] = position[k] / last[DISTANCE]
    for k in range(states.shape[0]):
        state, of = states[k].view(STATE)[0], last[DELAYS + EACH * k :]
        roll, pitch = state.tilt[0], state.tilt[1]
        of[ROW] = math.cos(pitch) * math.sin(roll)
        of[ROW + 1] = math.cos(pitch) * math.cos(roll)
        of[ROW + 2] = math.sin(pitch)
        of[LEVEL] = of[ROW] * last[DIRECTION] + of[ROW + 1] * last[DIRECTION + 1] + of[ROW + 2] * last[DIRECTION + 2]
        of[HEIGHT] = state.position[1]


@kernel
def measure(window: Floats, delays: Floats, extra: float, settings: Floats, scratch: Floats, left: Floats) -> float:
    """Return the logarithm of the ratio of the sums of squares; write the mean squares that the small delays leave.

    The delay in use is that of the small ones which is nearest to the one that was learned.
    """
    count, small, delayed, use = window.shape[0] - 1, len(left), len(delays), 0
    for k in range(small):
        if abs(delays[k] - extra) < abs(delays[use] - extra):
            use = k
    memory, noise, after, stride = settings[0], settings[1], int(settings[2]), int(settings[3])
    levels, sums, steps = scratch[:delayed], scratch[delayed : delayed + 5], scratch[delayed + 5, :count]
    write_levels(window, use, levels)
    for j in range(count):
        steps[j] = window[j + 1, TIME] - window[j, TIME]
    least = other = math.inf
    for k in range(small):
        left[k] = misfit(steps, levels[k], memory) / count
        least = min(least, count * left[k])
    write_sums(steps, levels[use], memory, sums)
    for change in range(0, count - after + 1, stride):  # so many differences are those in use
        for k in range(small, delayed):
            lag = delays[k] - delays[use]
            other = min(other, misfit_after(steps, levels[use], levels[k], (change, lag, memory), sums))
        other = min(other, misfit_still(window, use, (change, memory), sums))
    evidence: float = math.log((least + count * noise**2) / (other + count * noise**2))
    return evidence


@helper
def write_levels(window: Floats, use: int, levels: Floats) -> None:
    """Write r of each delay, (delays, poses); heights count from the last one of the delay in use."""
    count, distance = window.shape[0], 0.0
    for j in range(count):
        distance += window[j, DISTANCE] / count
    height = window[count - 1, DELAYS + EACH * use + HEIGHT]
    for j in range(count):
        of = window[j, DELAYS:]
        for k in range(levels.shape[0]):
            levels[k, j] = of[EACH * k + LEVEL] + (of[EACH * k + HEIGHT] - height) / max(distance, TINY)


@helper
def misfit(steps: Floats, levels: Floats, memory: float) -> float:
    """Sum of squares that a line leaves of whitened differences, without the largest: for one outlier."""
    count, step, value, squares, products = len(steps), 0.0, 0.0, 0.0, 0.0
    for j in range(count):
        step = steps[j] + memory * step
        value = levels[j + 1] - levels[j] + memory * value
        squares += step * step
        products += step * value
    slope, step, value, total, largest = products / max(squares, TINY), 0.0, 0.0, 0.0, 0.0
    for j in range(count):
        step = steps[j] + memory * step
        value = levels[j + 1] - levels[j] + memory * value
        square = (value - slope * step) ** 2
        total += square
        largest = max(largest, square)
    return float((total - largest) * count / (count - 1))


@helper
def write_sums(steps: Floats, levels: Floats, memory: float, sums: Floats) -> None:
    """Write of the first differences the last whitened step and value, and the sums of their products, (5, n + 1)."""
    sums[:, 0] = 0.0
    for j in range(len(steps)):
        step = steps[j] + memory * sums[0, j]
        value = levels[j + 1] - levels[j] + memory * sums[1, j]
        sums[0, j + 1], sums[1, j + 1] = step, value
        sums[2, j + 1] = sums[2, j] + step * step
        sums[3, j + 1] = sums[3, j] + step * value
        sums[4, j + 1] = sums[4, j] + value * value


@helper
def sums_before(sums: Floats, first: int) -> tuple[float, float, float, float, float]:
    """Return what `write_sums` wrote of so many first differences."""
    return sums[0, first], sums[1, first], sums[2, first], sums[3, first], sums[4, first]


@helper
def misfit_after(
    steps: Floats, before: Floats, levels: Floats, change: tuple[int, float, float], sums: Floats
) -> float:
    """Sum of squares that a line leaves, if after so many differences the delay is larger by a lag, s."""
    first, lag, memory = change
    step, value, squares, products, total = sums_before(sums, first)
    if first > 0:  # the difference in which the delay changes
        step = steps[first] - lag + memory * step
        value = levels[first + 1] - before[first] + memory * value
        squares, products, total = squares + step * step, products + step * value, total + value * value
        first += 1
    for j in range(first, len(steps)):
        step = steps[j] + memory * step
        value = levels[j + 1] - levels[j] + memory * value
        squares += step * step
        products += step * value
        total += value * value
    return float(total - products**2 / max(squares, TINY))


@helper
def misfit_still(window: Floats, use: int, change: tuple[int, float], sums: Floats) -> float:
    """Sum of squares that a line leaves, if after so many differences the picture stands still."""
    first, memory = change
    step, value, squares, products, total = sums_before(sums, first)
    row = window[first, DELAYS + EACH * use + ROW :]
    for j in range(first, window.shape[0] - 1):
        step, value = memory * step, memory * value
        for k in range(3):
            value += row[k] * (window[j + 1, DIRECTION + k] - window[j, DIRECTION + k])
        squares += step * step
        products += step * value
        total += value * value
    return float(total - products**2 / max(squares, TINY))

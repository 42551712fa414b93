"""The numbers of a flight, kept for its report: `FlightLog`."""

import math
from array import array

import numpy as np
import numpy.typing as npt

from matchset.app.flight.flight import SETTLING, Crash, Setting, Tick
from matchset.app.flight.pilot import Step
from matchset.app.flight.score import FlightTally
from matchset.app.flight_report.chain_frame import composed, from_last
from matchset.app.flight_report.true_circle import true_circle
from matchset.control.safety import Phase
from matchset.sim.world import lens_of
from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]

PHASES: tuple[Phase, ...] = ("locked", "flying", "holding", "descending", "cut")
_COLUMNS = 19
_NONE = (math.nan,) * 3


class FollowerLog:
    """One follower's numbers, a row a tick; NaN where there is none."""

    def __init__(self) -> None:
        self._numbers = array("d")

    def add(self, row: tuple[float, ...]) -> None:
        """Append a row."""
        self._numbers.extend(row)

    @property
    def _table(self) -> Floats:
        return np.array(self._numbers, np.float64).reshape(-1, _COLUMNS)

    @property
    def time(self) -> Floats:
        """When the commands were sent, (n,), s."""
        return self._table[:, 0]

    @property
    def believed(self) -> Floats:
        """Side, height and heading that the follower acted on, for the time of action, (n, 3), m."""
        return self._table[:, 1:4]

    @property
    def true(self) -> Floats:
        """The true ones at `time`, (n, 3), m."""
        return self._table[:, 4:7]

    @property
    def error_px(self) -> Floats:
        """Error of the ball's circle, |dx| + |dy| + |dr| (Eq. 10), (n,), px; NaN where it was not found."""
        return self._table[:, 7]

    @property
    def age(self) -> Floats:
        """From capture to command, (n,), s."""
        return self._table[:, 8]

    @property
    def processing(self) -> Floats:
        """Computing time, (n,), s; NaN where no picture came."""
        return self._table[:, 9]

    @property
    def found(self) -> npt.NDArray[np.bool_]:
        """Whether the ball was confirmed, (n,)."""
        return self._table[:, 10] > 0.0

    @property
    def phase(self) -> npt.NDArray[np.intp]:
        """Number of the safety's phase in `PHASES`, (n,)."""
        return self._table[:, 11].astype(np.intp)

    @property
    def inside(self) -> npt.NDArray[np.bool_]:
        """Whether the ball was to be seen, (n,)."""
        return self._table[:, 12] > 0.0

    @property
    def seen_from_last(self) -> Floats:
        """The camera in the level frame of the last ball, composed along the chain, (n, 3), m."""
        return self._table[:, 13:16]

    @property
    def true_from_last(self) -> Floats:
        """The true one, (n, 3), m."""
        return self._table[:, 16:19]


class FlightLog:
    """Takes note of every tick; 150 bytes a follower, so a flight may last for hours.

    Parameters
    ----------
    setting : Setting

    Attributes
    ----------
    setting : Setting
    followers : list of FollowerLog
    tally : FlightTally
    crashes : tuple of Crash
    """

    def __init__(self, setting: Setting) -> None:
        self.setting = setting
        self.followers = [FollowerLog() for _ in range(setting.followers)]
        self.tally = FlightTally(setting.followers)
        self.crashes: tuple[Crash, ...] = ()
        self._room = array("d")

    def add(self, tick: Tick) -> None:
        """Take note of a tick."""
        self.tally.count(tick)
        self.crashes = tick.crashes
        for sight in tick.shown:
            self._room.extend(sight.ball.tolist())
        for number, place in enumerate(composed(tick.steps)):
            self.followers[number].add(self._row(tick, number, place))

    @property
    def room(self) -> Floats:
        """Every vehicle's ball in the room, (n, vehicles, 3), m."""
        return np.array(self._room, np.float64).reshape(-1, self.setting.followers + 1, 3)

    def off_place(self, number: int) -> Floats:
        """Subtract the set place of a follower, from 0, from its true one, once it should be held: (n, 3), m."""
        log, place = self.followers[number], self.setting.parameters.pilot.place
        off: Floats = log.true - (place.side, place.height, place.heading)
        return off[log.time >= self.setting.parameters.counts(number)]

    def spread(self, number: int) -> Floats:
        """Root mean square of `off_place` in each axis, (3,), m; empty if the flight was not that long."""
        off = self.off_place(number)
        return np.sqrt((off**2).mean(axis=0)) if len(off) else np.empty(0)

    def _row(self, tick: Tick, number: int, place: Floats | None) -> tuple[float, ...]:
        step, answer = tick.steps[number], tick.steps[number].answer
        believed = _NONE if answer is None else (answer.side, answer.height, answer.heading)
        lens = lens_of(tick.shown[number])
        return (
            step.now,
            *believed,
            *tick.places[number].tolist(),
            self._error_px(tick, number, step),
            step.age,
            math.nan if step.frame is None else step.processing,
            float(isinstance(step.ball, Track)),
            float(PHASES.index(step.memory.phase)),
            float(tick.inside[number]),
            *(_NONE if place is None else place.tolist()),
            *from_last(lens, tick.shown[-1]).tolist(),
        )

    def _error_px(self, tick: Tick, number: int, step: Step) -> float:
        if not isinstance(step.ball, Track):
            return math.nan
        me, other = tick.shown[number], tick.shown[number + 1]
        truth, found = true_circle(me, other, self.setting.cameras[number], self.setting.radius), step.ball.shape
        if truth is None:
            return math.nan
        return abs(found.x - truth.x) + abs(found.y - truth.y) + abs(found.radius - truth.radius)


HEADINGS = (
    "",
    "pictures",
    "ball found where it was to be seen",
    "losses",
    "longest, s",
    "error of the circle, px (mean, 95 %)",
    f"off the set place, cm rms, from {SETTLING:g} s after its start on (side, height, heading)",
    "age, ms (median, 95 %)",
    "computing, µs (median)",
    "at the end",
)


def follower_figures(log: FlightLog, number: int) -> tuple[str, ...]:
    """Say one follower's figures, in the order of `HEADINGS`.

    Parameters
    ----------
    log : FlightLog
    number : int
        From 0.
    """
    follower, figures = log.followers[number], log.tally.followers[number]
    to_see, error = follower.inside, follower.error_px[np.isfinite(follower.error_px)]
    age = 1000.0 * follower.age[np.isfinite(follower.age)]
    spent = 1e6 * follower.processing[np.isfinite(follower.processing)]
    off = 100.0 * log.spread(number)
    return (
        f"{number + 1} watches {number + 2}",
        str(figures.frames),
        f"{100.0 * float(follower.found[to_see].mean()):.1f} %" if to_see.any() else "-",
        str(figures.losses),
        f"{figures.longest:.2f}",
        f"{error.mean():.2f}, {np.percentile(error, 95):.2f}" if len(error) else "-",
        ", ".join(f"{value:.1f}" for value in off.tolist()) or "-",
        f"{np.median(age):.0f}, {np.percentile(age, 95):.0f}" if len(age) else "-",
        f"{np.median(spent):.0f}" if len(spent) else "-",
        _end(log, number),
    )


def verdict(log: FlightLog) -> str:
    """Say in one sentence how the flight ended."""
    time = f"{log.tally.time:.1f} s"
    if log.crashes:
        return f"{time}; " + "; ".join(each.words for each in log.crashes)
    if not log.tally.ticks:
        return "nothing was flown"
    down = [str(k + 1) for k, follower in enumerate(log.followers) if PHASES[follower.phase[-1]] == "cut"]
    if down:
        return f"{time}; vehicle {' and '.join(down)} came down along the safety path"
    spread = [value for k in range(len(log.followers)) for value in log.spread(k).tolist()]
    if not spread:
        return f"{time}, nobody crashed"
    return f"{time}, nobody crashed; worst axis {100.0 * max(spread):.1f} cm rms off the set place"


def _end(log: FlightLog, number: int) -> str:
    for crash in log.crashes:
        if crash.vehicle == number + 1:
            return f"{crash.what} at {crash.time:.1f} s"
    phase = log.followers[number].phase
    return PHASES[phase[-1]] if len(phase) else "-"

"""The numbers of a flight, kept for its report: `FlightLog`."""

import math
from array import array

import numpy as np
import numpy.typing as npt

from matchset.app.flight.flight import SETTLING, ChainStep, Crash, FlightSetup
from matchset.app.flight.pilot import PilotStep
from matchset.app.flight.score import FlightCounters
from matchset.app.flight_report.chain_frame import camera_positions, room_to_chain_frame
from matchset.app.flight_report.true_circle import true_circle
from matchset.control.safety import Phase
from matchset.sim.world import camera_position
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
    def estimated(self) -> Floats:
        """Side, height and heading that the follower acted on, for the time of action, (n, 3), m."""
        return self._table[:, 1:4]

    @property
    def true(self) -> Floats:
        """The true ones at `time`, (n, 3), m."""
        return self._table[:, 4:7]

    @property
    def circle_error_px(self) -> Floats:
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
    def in_view(self) -> npt.NDArray[np.bool_]:
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
    setup : FlightSetup

    Attributes
    ----------
    setup : FlightSetup
    followers : list of FollowerLog
    counters : FlightCounters
    crashes : tuple of Crash
    """

    def __init__(self, setup: FlightSetup) -> None:
        self.setup = setup
        self.followers = [FollowerLog() for _ in range(setup.followers)]
        self.counters = FlightCounters(setup.followers)
        self.crashes: tuple[Crash, ...] = ()
        self._room = array("d")

    def add(self, chain_step: ChainStep) -> None:
        """Take note of a tick."""
        self.counters.add(chain_step)
        self.crashes = chain_step.crashes
        for sight in chain_step.truth_at_exposure:
            self._room.extend(sight.ball.tolist())
        for number, place in enumerate(camera_positions(chain_step.steps)):
            self.followers[number].add(self._row(chain_step, number, place))

    @property
    def room(self) -> Floats:
        """Every vehicle's ball in the room, (n, vehicles, 3), m."""
        return np.array(self._room, np.float64).reshape(-1, self.setup.followers + 1, 3)

    def position_error(self, number: int) -> Floats:
        """Subtract the set place of a follower, from 0, from its true one, once it should be held: (n, 3), m."""
        log, place = self.followers[number], self.setup.parameters.pilot.place
        off: Floats = log.true - (place.side, place.height, place.heading)
        return off[log.time >= self.setup.parameters.evaluation_start(number)]

    def spread(self, number: int) -> Floats:
        """Root mean square of `position_error` in each axis, (3,), m; empty if the flight was not that long."""
        off = self.position_error(number)
        return np.sqrt((off**2).mean(axis=0)) if len(off) else np.empty(0)

    def _row(self, chain_step: ChainStep, number: int, place: Floats | None) -> tuple[float, ...]:
        step, control = chain_step.steps[number], chain_step.steps[number].control
        estimated = _NONE if control is None else (control.side, control.height, control.heading)
        lens = camera_position(chain_step.truth_at_exposure[number])
        return (
            step.now,
            *estimated,
            *chain_step.true_positions[number].tolist(),
            self._error_px(chain_step, number, step),
            step.age,
            math.nan if step.frame is None else step.processing,
            float(isinstance(step.ball, Track)),
            float(PHASES.index(step.safety.phase)),
            float(chain_step.in_view[number]),
            *(_NONE if place is None else place.tolist()),
            *room_to_chain_frame(lens, chain_step.truth_at_exposure[-1]).tolist(),
        )

    def _error_px(self, chain_step: ChainStep, number: int, step: PilotStep) -> float:
        if not isinstance(step.ball, Track):
            return math.nan
        me, other = chain_step.truth_at_exposure[number], chain_step.truth_at_exposure[number + 1]
        truth, found = true_circle(me, other, self.setup.cameras[number], self.setup.radius), step.ball.shape
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


def follower_row(log: FlightLog, number: int) -> tuple[str, ...]:
    """Say one follower's figures, in the order of `HEADINGS`.

    Parameters
    ----------
    log : FlightLog
    number : int
        From 0.
    """
    follower, figures = log.followers[number], log.counters.followers[number]
    to_see, error = follower.in_view, follower.circle_error_px[np.isfinite(follower.circle_error_px)]
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
    time = f"{log.counters.time:.1f} s"
    if log.crashes:
        return f"{time}; " + "; ".join(each.words for each in log.crashes)
    if not log.counters.chain_steps:
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

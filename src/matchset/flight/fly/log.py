"""The numbers of a flight, kept for its report: `FlightLog`; as text: `follower_row`, `flight_summary`."""

import math
from array import array

import numpy as np
import numpy.typing as npt

from matchset.app.timing.durations import times_of
from matchset.control.safety import Phase
from matchset.flight.chain.chain_step import ChainStep, Crash, FlightSetup
from matchset.flight.chain.pilot import PilotStep
from matchset.flight.chain.score import SCORING, FlightCounters, scored_from
from matchset.flight.report.chain_frame import camera_positions, room_to_chain_frame
from matchset.flight.report.gain_notes import GainNotes
from matchset.flight.report.true_circle import true_circle
from matchset.sim.world import camera_position
from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]

PHASES: tuple[Phase, ...] = ("locked", "flying", "holding", "descending", "cut")

# format: a row of `FollowerLog`, all float64; what is not known is NaN
ROW = np.dtype(
    [
        ("time", np.float64),
        ("estimated_position", np.float64, 3),
        ("true_position", np.float64, 3),
        ("circle_error_px", np.float64),
        ("age", np.float64),
        ("processing", np.float64),
        ("found", np.float64),
        ("phase", np.float64),
        ("in_view", np.float64),
        ("estimated_in_chain", np.float64, 3),
        ("true_in_chain", np.float64, 3),
    ]
)
UNKNOWN = (math.nan, math.nan, math.nan)
"""A position that is not known."""


class FollowerLog:
    """One follower's numbers, a row for each step of the flight; NaN where there is none."""

    def __init__(self) -> None:
        self._numbers = array("d")

    def add(self, row: tuple[float, ...]) -> None:
        """Append a row, in the order of `ROW`."""
        self._numbers.extend(row)

    def _column(self, name: str) -> Floats:
        column: Floats = np.array(self._numbers, np.float64).view(ROW)[name]
        return column

    @property
    def time(self) -> Floats:
        """When the commands were sent, (n,), s."""
        return self._column("time")

    @property
    def estimated_position(self) -> Floats:
        """Side, height and heading that the follower acted on, for the time at which the command acts, (n, 3), m."""
        return self._column("estimated_position")

    @property
    def true_position(self) -> Floats:
        """True side, height and heading at `time`, (n, 3), m."""
        return self._column("true_position")

    @property
    def circle_error_px(self) -> Floats:
        """Error of the ball's circle, |dx| + |dy| + |dr| (Eq. 10), (n,), px; NaN where it was not found."""
        return self._column("circle_error_px")

    @property
    def age(self) -> Floats:
        """From capture to command, (n,), s."""
        return self._column("age")

    @property
    def processing(self) -> Floats:
        """Computing time, (n,), s; NaN where no picture came."""
        return self._column("processing")

    @property
    def found(self) -> npt.NDArray[np.bool_]:
        """Whether the ball was confirmed, (n,)."""
        return self._column("found") > 0.0

    @property
    def phase(self) -> npt.NDArray[np.intp]:
        """Phase of the safety filter as an index into `PHASES`, (n,)."""
        return self._column("phase").astype(np.intp)

    @property
    def has_flown(self) -> bool:
        """Whether it took off."""
        return bool((self.phase > PHASES.index("locked")).any())

    @property
    def in_view(self) -> npt.NDArray[np.bool_]:
        """Whether the ball was inside the picture, by the truth, (n,)."""
        return self._column("in_view") > 0.0

    @property
    def estimated_in_chain(self) -> Floats:
        """The camera in the level frame of the last ball, by the poses measured along the chain, (n, 3), m."""
        return self._column("estimated_in_chain")

    @property
    def true_in_chain(self) -> Floats:
        """The camera in the level frame of the last ball, by the truth, (n, 3), m."""
        return self._column("true_in_chain")


class FlightLog:
    """Keeps the numbers of every step; 150 bytes a follower, so a flight may last for hours.

    Parameters
    ----------
    setup : FlightSetup

    Attributes
    ----------
    setup : FlightSetup
    followers : list of FollowerLog
    counters : FlightCounters
    crashes : tuple of Crash
    shown : ChainStep or None
        A step from the second half of the flight in which every ball was found, for a picture of it; the first one with
        pictures where there is none such.
    stops : dict of int to str
        Why the motors of a follower, from 0, were stopped from outside, see `PilotStep.stopped`.
    landings : dict of int to str
        Why a follower, from 0, was told to land, see `PilotStep.landing`.
    gains : GainNotes
    """

    def __init__(self, setup: FlightSetup) -> None:
        self.setup = setup
        self.followers = [FollowerLog() for _ in range(setup.followers)]
        self.counters = FlightCounters(setup.followers)
        self.crashes: tuple[Crash, ...] = ()
        self.stops: dict[int, str] = {}
        self.landings: dict[int, str] = {}
        self.gains = GainNotes(setup.followers)
        self.shown: ChainStep | None = None
        self._balls_in_room = array("d")

    def add(self, chain_step: ChainStep) -> None:
        """Append a step of the flight."""
        self.counters.add(chain_step)
        self._choose(chain_step)
        self.crashes = chain_step.crashes
        for sight in chain_step.truth_at_exposure:
            self._balls_in_room.extend(sight.ball.tolist())
        self.stops |= {number: step.stopped for number, step in enumerate(chain_step.steps) if step.stopped}
        self.landings |= {number: step.landing for number, step in enumerate(chain_step.steps) if step.landing}
        self.gains.add(chain_step.time, chain_step.steps)
        for number, position in enumerate(camera_positions(chain_step.steps)):
            self.followers[number].add(self._row(chain_step, number, position))

    def _choose(self, chain_step: ChainStep) -> None:
        """Keep a step to show; each is replaced by one that comes at twice its time."""
        steps = chain_step.steps
        if self.shown is None:
            if all(step.frame is not None for step in steps):
                self.shown = chain_step
        elif chain_step.time >= 2.0 * self.shown.time and all(isinstance(step.ball, Track) for step in steps):
            self.shown = chain_step

    @property
    def balls_in_room(self) -> Floats:
        """True position of every vehicle's ball in the room, (n, vehicles, 3), m."""
        return np.array(self._balls_in_room, np.float64).reshape(-1, self.setup.followers + 1, 3)

    def position_error(self, number: int) -> Floats:
        """Subtract the set place of a follower, from 0, from its position, from `scored_from` on: (n, 3), m.

        The position is the true one; where nobody knows that, the one that the follower acted on.
        """
        log, place = self.followers[number], self.setup.parameters.pilot.place
        position = log.true_position if self.setup.has_truth else log.estimated_position
        error: Floats = position - (place.side, place.height, place.heading)
        counts = log.time >= self.setup.countdown + scored_from(self.setup.parameters, number)
        if not self.setup.has_truth:
            counts &= (log.phase <= PHASES.index("holding")) & np.isfinite(error).all(axis=1)
        return error[counts]

    def spread(self, number: int) -> Floats:
        """Root mean square of `position_error` in each axis, (3,), m; empty if the flight was not that long."""
        error = self.position_error(number)
        return np.sqrt((error**2).mean(axis=0)) if len(error) else np.empty(0)

    def _row(self, chain_step: ChainStep, number: int, position: Floats | None) -> tuple[float, ...]:
        """Make a row of a step, in the order of `ROW`."""
        step, control = chain_step.steps[number], chain_step.steps[number].control
        sights = chain_step.truth_at_exposure
        true_in_chain = room_to_chain_frame(camera_position(sights[number]), sights[-1]).tolist() if sights else UNKNOWN
        return (
            step.now,
            *(UNKNOWN if control is None else (control.side, control.height, control.heading)),
            *chain_step.true_positions[number].tolist(),
            self._circle_error_px(chain_step, number, step),
            step.age,
            math.nan if step.frame is None else step.processing,
            float(isinstance(step.ball, Track)),
            float(PHASES.index(step.safety.phase)),
            float(chain_step.in_view[number]),
            *(UNKNOWN if position is None else position.tolist()),
            *true_in_chain,
        )

    def _circle_error_px(self, chain_step: ChainStep, number: int, step: PilotStep) -> float:
        if not isinstance(step.ball, Track) or not chain_step.truth_at_exposure:
            return math.nan
        me, other = chain_step.truth_at_exposure[number], chain_step.truth_at_exposure[number + 1]
        truth, found = true_circle(me, other, self.setup.cameras[number], self.setup.radius), step.ball.shape
        if truth is None:
            return math.nan
        return abs(found.x - truth.x) + abs(found.y - truth.y) + abs(found.radius - truth.radius)


FIGURES = "median, mean, 95 %, worst"
"""Of times, in the order of `_figures`."""
HEADINGS = (
    "",
    "pictures",
    "ball found",
    "losses",
    "longest loss, s",
    "circle error, px",
    "off the set place, cm",
    "age, ms",
    "computing, µs",
    "margins",
    "at the end",
)
EXPLANATIONS = (
    "",
    "",
    "of those in which it was to be seen",
    "",
    "",
    "mean, 95 %",
    f"side, height, heading: rms from {SCORING.transient:g} s after its start on",
    f"picture to command: {FIGURES}",
    FIGURES,
    "least gain and phase margin of its loops, with the gains in use",
    "phase of the safety filter",
)
"""What each of `HEADINGS` means, where that does not say it."""
UNTRUE = {EXPLANATIONS[2]: "of all pictures", EXPLANATIONS[6]: f"{EXPLANATIONS[6]}, by its own eyes"}
"""What some of them mean where nobody knows the truth."""


def follower_row(log: FlightLog, number: int) -> tuple[str, ...]:
    """Write one follower's figures, in the order of `HEADINGS`.

    Parameters
    ----------
    log : FlightLog
    number : int
        From 0.
    """
    follower, counters = log.followers[number], log.counters.followers[number]
    in_view, error = follower.in_view, follower.circle_error_px[np.isfinite(follower.circle_error_px)]
    spread = 100.0 * log.spread(number)
    return (
        f"{number + 1} watches {number + 2}",
        str(counters.frames),
        f"{100.0 * float(follower.found[in_view].mean()):.1f} %" if in_view.any() else "-",
        str(counters.losses),
        f"{counters.longest:.2f}",
        f"{error.mean():.2f}, {np.percentile(error, 95):.2f}" if len(error) else "-",
        ", ".join(f"{value:.1f}" for value in spread.tolist()) or "-",
        _figures(follower.age, 1e3),
        _figures(follower.processing, 1e6),
        log.gains.margins_text(number),
        _end(log, number),
    )


def _figures(seconds: Floats, factor: float) -> str:
    """Write `FIGURES` of times, in another unit."""
    times = times_of(seconds)
    if times is None:
        return "-"
    return ", ".join(f"{factor * each:.0f}" for each in (times.median, times.mean, times.percentile_95, times.worst))


def flight_summary(log: FlightLog) -> str:
    """Say in one sentence how the flight ended."""
    time = f"{log.counters.time:.1f} s"
    if log.crashes:
        return f"{time}; " + "; ".join(each.description for each in log.crashes)
    if not log.counters.chain_steps:
        return "nothing was flown"
    if log.stops:
        return f"{time}; " + "; ".join(f"vehicle {k + 1} was cut: {reason}" for k, reason in sorted(log.stops.items()))
    down = [
        str(k + 1)
        for k, follower in enumerate(log.followers)
        if PHASES[follower.phase[-1]] == "cut" and k not in log.landings
    ]
    if down:
        return f"{time}; vehicle {' and '.join(down)} came down along the safety path"
    spread = [value for k in range(len(log.followers)) for value in log.spread(k).tolist()]
    if not log.setup.has_truth and not any(follower.has_flown for follower in log.followers):
        return f"{time}; nobody took off"
    if not spread:
        return f"{time}, nobody crashed{_lowered(log)}"
    by = "" if log.setup.has_truth else " by its own eyes"
    return f"{time}, nobody crashed; worst axis {100.0 * max(spread):.1f} cm rms off the set place{by}{_lowered(log)}"


def _lowered(log: FlightLog) -> str:
    """Say whose gains were lowered in the flight."""
    numbers = [str(number + 1) for number in sorted({number for _, number, _ in log.gains.lowered})]
    return f"; gains of vehicle {' and '.join(numbers)} were lowered" if numbers else ""


def _end(log: FlightLog, number: int) -> str:
    for crash in log.crashes:
        if crash.vehicle == number + 1:
            return f"{crash.what} at {crash.time:.1f} s"
    phase = log.followers[number].phase
    if number in log.stops:
        return f"cut: {log.stops[number]}"
    if number in log.landings:
        return f"landed: {log.landings[number]}"
    return PHASES[phase[-1]] if len(phase) else "-"

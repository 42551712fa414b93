"""A flight in numbers: `FlightScore` against the limits of a series, `FlightCounters` for the view while it flies.

Both are made of the flight's `ChainStep`s. What counts as survived, in view, spread and settled: decision 052.
"""

import copy
import math
from array import array
from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.flight.chain.chain_step import ChainStep
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import PilotStep
from matchset.localization.pose import Pose
from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]

LANDING_PHASES = ("descending", "cut")
"""Phases of the safety filter in which a vehicle comes down."""


class FlightScoreParameters(msgspec.Struct, frozen=True, kw_only=True):
    """What counts in a score. Chosen by decision 052.

    Parameters
    ----------
    transient : float
        Time after a follower is armed in which its position does not count for the spread, s: the start-up, in which
        the controllers learn the throttle that hovers. More hides a slow start, less mixes it into the spread.
    settled_distance : float
        A follower has settled when it is nearer than this to its set place in every axis, m.
    settled_duration : float
        And stays there for at least this long, s.
    """

    transient: float = 5.0
    settled_distance: float = 0.15
    settled_duration: float = 1.0


SCORING = FlightScoreParameters()


def scored_from(parameters: FlightParameters, follower: int) -> float:
    """Time from which on the position of a follower, from 0, counts for its spread, s."""
    return parameters.arming_time(follower) + SCORING.transient


class FlightScore(msgspec.Struct, frozen=True, kw_only=True):
    """One flight in numbers.

    Parameters
    ----------
    seed : int
    duration : float
        Planned length, s.
    end : float
        When the last command was sent, or the first crash happened, s.
    crash : str
        What happened, empty if nothing.
    landing_reason : str
        Why safety ended the flight, empty if it did not.
    in_view : tuple of float
        Share of the pictures in which each follower's ball was inside, by the truth.
    found : tuple of float
        Share of the pictures for which its loop measured the ball's pose.
    losses : tuple of int
        Number of times it went from measured to not measured.
    spread : tuple of (float, float, float)
        Root mean square of position minus set place, side, height and heading of each follower, m, from
        `FlightScoreParameters.transient` after its arming on; empty if the flight was not that long.
    settling_time : float
        When the last follower had settled, see `settling_time`, s; inf if one never did.
    descent_time : float
        When safety first began to bring a vehicle down, s; inf if it never did.
    processing : float
        Median computing time of track, localize, control and send, s.
    age : float
        Median age of the picture when its command left, s.
    """

    seed: int
    duration: float
    end: float
    crash: str
    landing_reason: str
    in_view: tuple[float, ...]
    found: tuple[float, ...]
    losses: tuple[int, ...]
    spread: tuple[tuple[float, float, float], ...]
    settling_time: float
    descent_time: float
    processing: float
    age: float

    @property
    def survived(self) -> bool:
        """Whether everyone flew to the end."""
        return not self.crash and not self.landing_reason

    @property
    def worst_spread(self) -> float:
        """Largest spread of all followers and axes, m; inf if there is none."""
        return max((value for each in self.spread for value in each), default=math.inf)


class FlightScorer:
    """Makes the score of a flight of its steps.

    Parameters
    ----------
    parameters : FlightParameters
        Of the flight.
    """

    def __init__(self, parameters: FlightParameters) -> None:
        self.parameters = parameters
        place = parameters.pilot.place
        self._set_place = np.array((place.side, place.height, place.heading))
        count = parameters.world.vehicles - 1
        self._time = array("d")
        self._position_error = array("d")
        self._in_view = np.zeros(count, np.int64)
        self._found = np.zeros(count, np.int64)
        self._losses = np.zeros(count, np.int64)
        self._was_found = [False] * count
        self._processing, self._age = array("d"), array("d")
        self._descent_time, self._crash, self._landing_reason = math.inf, "", ""

    def add(self, chain_step: ChainStep) -> None:
        """Count the next step of the flight."""
        self._time.append(chain_step.time)
        self._position_error.extend((chain_step.true_positions - self._set_place).ravel().tolist())
        for follower, step in enumerate(chain_step.steps):
            found = isinstance(step.pose, Pose)
            self._in_view[follower] += chain_step.in_view[follower]
            self._found[follower] += found
            self._losses[follower] += self._was_found[follower] and not found
            self._was_found[follower] = found
            self._processing.append(step.processing)
            self._age.append(step.age)
            if step.safety.phase in LANDING_PHASES and not self._landing_reason:
                self._landing_reason = f"vehicle {follower + 1}: {step.safety.reason}"
                self._descent_time = chain_step.time
        if chain_step.crashes and not self._crash:
            self._crash = chain_step.crashes[0].description

    @property
    def crashed(self) -> bool:
        """Whether somebody crashed: what follows says nothing more."""
        return bool(self._crash)

    def score(self) -> FlightScore:
        """Return the score of the steps so far."""
        steps = max(len(self._time), 1)
        time = np.array(self._time)
        error = np.array(self._position_error).reshape(len(self._time), -1, 3)
        late = [error[time >= scored_from(self.parameters, k), k] for k in range(error.shape[1])]
        spread = [np.sqrt((each**2).mean(axis=0)) for each in late] if all(len(each) for each in late) else []
        return FlightScore(
            seed=self.parameters.world.seed,
            duration=self.parameters.duration,
            end=float(time[-1]) if len(time) else 0.0,
            crash=self._crash,
            landing_reason=self._landing_reason,
            in_view=tuple((self._in_view / steps).tolist()),
            found=tuple((self._found / steps).tolist()),
            losses=tuple(self._losses.tolist()),
            spread=tuple((float(a), float(b), float(c)) for a, b, c in spread),
            settling_time=settling_time(time, error),
            descent_time=self._descent_time,
            processing=float(np.median(self._processing)) if self._processing else 0.0,
            age=float(np.median(self._age)) if self._age else 0.0,
        )


def settling_time(time: Floats, position_error: Floats, parameters: FlightScoreParameters = SCORING) -> float:
    """Find when the last follower had settled: near its set place for the first time to stay there.

    Parameters
    ----------
    time : ndarray of shape (n,)
        s.
    position_error : ndarray of shape (n, followers, 3)
        Position minus set place, m.
    parameters : FlightScoreParameters
        How near, and how long.

    Returns
    -------
    float
        s; inf if a follower never settled.
    """
    stay, last = parameters.settled_duration, 0.0
    for follower in range(position_error.shape[1]):
        near = np.asarray((np.abs(position_error[:, follower]) <= parameters.settled_distance).all(axis=1))
        starts = [k for k in np.flatnonzero(near) if near[(time >= time[k]) & (time <= time[k] + stay)].all()]
        starts = [k for k in starts if time[-1] - time[k] >= stay]
        if not starts:
            return math.inf
        last = max(last, float(time[starts[0]]))
    return last


class FollowerCounters:
    """Pictures and losses of one follower.

    Attributes
    ----------
    frames : int
        Pictures that came.
    missing : int
        Steps without a picture.
    lost : int
        Pictures in which the ball was not confirmed.
    losses : int
        Number of times it went from confirmed to not confirmed.
    longest : float
        The longest time without the ball, s.
    reason : str
        Of the last loss.
    """

    RATE_FRAMES = 30  # format: pictures over which the rate is averaged, about a second

    def __init__(self) -> None:
        self.frames = self.missing = self.lost = self.losses = 0
        self.longest = 0.0
        self.reason = ""
        self._was_found, self._found_time = True, 0.0
        self._frame_times: Sequence[float] = ()

    def add(self, step: PilotStep) -> None:
        """Count a step of the follower's loop."""
        found = isinstance(step.ball, Track)
        self.frames += step.frame is not None
        self.missing += step.frame is None
        self.lost += step.frame is not None and not found
        if found:
            self._found_time = step.now
        else:
            self.longest = max(self.longest, step.now - self._found_time)
            self.losses += self._was_found
            self.reason = "" if isinstance(step.ball, Track) else step.ball.reason
        self._was_found = found
        if step.frame is not None:
            self._frame_times = [*self._frame_times[-self.RATE_FRAMES :], step.frame.time]

    @property
    def rate(self) -> float | None:
        """Pictures per second of their own clock, over the last second; None at first."""
        times = self._frame_times
        if len(times) < 2 or times[-1] <= times[0]:
            return None
        return (len(times) - 1) / (times[-1] - times[0])


class FlightCounters:
    """Counters of a flight so far.

    Parameters
    ----------
    followers : int

    Attributes
    ----------
    chain_steps : int
        Number of steps.
    time : float
        Of the last step, s.
    followers : list of FollowerCounters
    """

    def __init__(self, followers: int) -> None:
        self.chain_steps, self.time = 0, 0.0
        self.followers = [FollowerCounters() for _ in range(followers)]

    def copy(self) -> "FlightCounters":
        """Return them as they are now."""
        other = copy.copy(self)
        other.followers = [copy.copy(each) for each in self.followers]
        return other

    def add(self, chain_step: ChainStep) -> None:
        """Count a step of the flight."""
        self.chain_steps, self.time = self.chain_steps + 1, chain_step.time
        for follower, step in zip(self.followers, chain_step.steps, strict=True):
            follower.add(step)

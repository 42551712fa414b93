"""What a flight was worth against the limits: `FlightScorer` takes its ticks, `FlightScore` is a line of the table."""

import math
from array import array

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.flight.flight import ChainStep, FlightParameters
from matchset.app.flight.pilot import PilotStep
from matchset.localization.pose import Pose
from matchset.tracking.track import Track

Floats = npt.NDArray[np.float64]

NEAR = 0.15  # m, in every axis: a follower nearer than that to its set place has settled
DOWN = ("descending", "cut")


class FlightScore(msgspec.Struct, frozen=True, kw_only=True):
    """One flight in numbers.

    Parameters
    ----------
    seed : int
    duration : float
        How long it was to be, s.
    end : float
        When the last command was sent, or the first crash happened, s.
    crash : str
        What happened, empty if nothing.
    landing_reason : str
        Why safety ended the flight, empty if it did not.
    in_view : tuple of float
        Share of the pictures in which each follower's ball was inside.
    found : tuple of float
        Share of the pictures in which its loop placed the ball.
    losses : tuple of int
        How often it went from placed to not placed.
    spread : tuple of (float, float, float)
        Root mean square of place minus set place from 5 s after its beginning on, side, height and heading of each
        follower, m; empty if the flight was not that long.
    settling_time : float
        When the last follower had come within 0.15 m of its set place in every axis for the first time to stay there
        for a second, s; inf if one never did.
    descent_time : float
        When the first safety began to bring a vehicle down, s; inf if none did.
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
        """Of all followers and axes, m; inf if there is none."""
        return max((value for each in self.spread for value in each), default=math.inf)


class FlightScorer:
    """Takes the ticks of a flight.

    Parameters
    ----------
    parameters : FlightParameters
        Of the flight.
    """

    def __init__(self, parameters: FlightParameters) -> None:
        self.parameters = parameters
        place = parameters.pilot.place
        self._goal = np.array((place.side, place.height, place.heading))
        count = parameters.world.vehicles - 1
        self._time = array("d")
        self._off = array("d")
        self._inside = np.zeros(count, np.int64)
        self._found = np.zeros(count, np.int64)
        self._losses = np.zeros(count, np.int64)
        self._had = [False] * count
        self._spent, self._age = array("d"), array("d")
        self._down, self._crash, self._landed = math.inf, "", ""

    def add(self, chain_step: ChainStep) -> None:
        """Take the next tick into account."""
        self._time.append(chain_step.time)
        self._off.extend((chain_step.true_positions - self._goal).ravel().tolist())
        for who, step in enumerate(chain_step.steps):
            placed = isinstance(step.pose, Pose)
            self._inside[who] += chain_step.in_view[who]
            self._found[who] += placed
            self._losses[who] += self._had[who] and not placed
            self._had[who] = placed
            self._spent.append(step.processing)
            self._age.append(step.age)
            if step.safety.phase in DOWN and not self._landed:
                self._landed, self._down = f"vehicle {who + 1}: {step.safety.reason}", chain_step.time
        if chain_step.crashes and not self._crash:
            self._crash = chain_step.crashes[0].words

    @property
    def crashed(self) -> bool:
        """Whether somebody crashed: what follows says nothing more."""
        return bool(self._crash)

    def score(self) -> FlightScore:
        """Sum up what was taken."""
        chain_steps = max(len(self._time), 1)
        time = np.array(self._time)
        off = np.array(self._off).reshape(len(self._time), -1, 3)
        late = [off[time >= self.parameters.evaluation_start(who), who] for who in range(off.shape[1])]
        spread = [np.sqrt((each**2).mean(axis=0)) for each in late] if all(len(each) for each in late) else []
        return FlightScore(
            seed=self.parameters.world.seed,
            duration=self.parameters.duration,
            end=float(time[-1]) if len(time) else 0.0,
            crash=self._crash,
            landing_reason=self._landed,
            in_view=tuple((self._inside / chain_steps).tolist()),
            found=tuple((self._found / chain_steps).tolist()),
            losses=tuple(self._losses.tolist()),
            spread=tuple((float(a), float(b), float(c)) for a, b, c in spread),
            settling_time=settling_time(time, off),
            descent_time=self._down,
            processing=float(np.median(self._spent)) if self._spent else 0.0,
            age=float(np.median(self._age)) if self._age else 0.0,
        )


def settling_time(time: Floats, off: Floats) -> float:
    """When the last follower had come near its set place to stay for a second, s; inf if one never did.

    Parameters
    ----------
    time : ndarray of shape (n,)
        s.
    off : ndarray of shape (n, followers, 3)
        Place minus set place, m.
    """
    last = 0.0
    for who in range(off.shape[1]):
        near = np.asarray((np.abs(off[:, who]) <= NEAR).all(axis=1))
        begins = [k for k in np.flatnonzero(near) if near[(time >= time[k]) & (time <= time[k] + 1.0)].all()]
        begins = [k for k in begins if time[-1] - time[k] >= 1.0]
        if not begins:
            return math.inf
        last = max(last, float(time[begins[0]]))
    return last


class FollowerCounters:
    """How one follower's pictures went.

    Attributes
    ----------
    frames : int
        Pictures that came.
    missing : int
        Turns without a picture.
    lost : int
        Pictures in which the ball was not confirmed.
    losses : int
        How often it went from seen to not seen.
    longest : float
        The longest time without it, s.
    reason : str
        Of the last loss.
    """

    def __init__(self) -> None:
        self.frames = self.missing = self.lost = self.losses = 0
        self.longest = 0.0
        self.reason = ""
        self._seen, self._since = True, 0.0
        self._times: list[float] = []

    def add(self, step: PilotStep) -> None:
        """Take a turn of the loop into account."""
        found = isinstance(step.ball, Track)
        self.frames += step.frame is not None
        self.missing += step.frame is None
        self.lost += step.frame is not None and not found
        if found:
            self._since = step.now
        else:
            self.longest = max(self.longest, step.now - self._since)
            self.losses += self._seen
            self.reason = "" if isinstance(step.ball, Track) else step.ball.reason
        self._seen = found
        if step.frame is not None:
            self._times = [*self._times[-30:], step.frame.time]

    @property
    def rate(self) -> float | None:
        """Pictures per second of their own clock, over the last second; None at first."""
        if len(self._times) < 2 or self._times[-1] <= self._times[0]:
            return None
        return (len(self._times) - 1) / (self._times[-1] - self._times[0])


class FlightCounters:
    """How a flight went.

    Parameters
    ----------
    followers : int

    Attributes
    ----------
    ticks : int
    time : float
        Of the last tick, s.
    followers : list of FollowerCounters
    """

    def __init__(self, followers: int) -> None:
        self.chain_steps, self.time = 0, 0.0
        self.followers = [FollowerCounters() for _ in range(followers)]

    def add(self, chain_step: ChainStep) -> None:
        """Take a tick into account."""
        self.chain_steps, self.time = self.chain_steps + 1, chain_step.time
        for follower, step in zip(self.followers, chain_step.steps, strict=True):
            follower.add(step)

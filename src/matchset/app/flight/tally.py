"""Figures of a flight as it goes on: `FlightTally`, with a `FollowerTally` for each."""

from matchset.app.flight.flight import Tick
from matchset.app.flight.pilot import Step
from matchset.tracking.track import Track


class FollowerTally:
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

    def count(self, step: Step) -> None:
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


class FlightTally:
    """How a flight went.

    Parameters
    ----------
    followers : int

    Attributes
    ----------
    ticks : int
    time : float
        Of the last tick, s.
    followers : list of FollowerTally
    """

    def __init__(self, followers: int) -> None:
        self.ticks, self.time = 0, 0.0
        self.followers = [FollowerTally() for _ in range(followers)]

    def count(self, tick: Tick) -> None:
        """Take a tick into account."""
        self.ticks, self.time = self.ticks + 1, tick.time
        for follower, step in zip(self.followers, tick.steps, strict=True):
            follower.count(step)

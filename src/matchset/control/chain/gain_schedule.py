"""Gains that go with the delay and with the length of the chain: `GainSchedule`.

Two things ask for low gains: a long delay, from the exposure of a picture to the effect of the command that answers
it, and a long chain, in which each vehicle enlarges what its neighbor does wrong (Swaroop & Hedrick 1996).
A short chain with a short delay is held tighter and follows its neighbor in full. In between every gain is interpolated
(gain scheduling, Rugh & Shamma 2000): with the share w, k = (1 - w) k_low + w k_high,

    w = w_0 (t_1 - t) / (t_1 - t_0) (s - s_0) / (s_1 - s_0),    both factors within 0 ... 1,

t the delay and s the time since lift-off: who goes along in full with a neighbor that sinks, or rises, in its own start
does not learn the throttle that hovers.
"""

import math
from typing import NamedTuple

import msgspec

from matchset.control.command import clip
from matchset.control.feedforward import FeedforwardParameters
from matchset.control.pid import PidParameters
from matchset.numeric.arguments import require, require_not_negative, require_positive, require_share

ENTRIES = 21  # format: of the table of gains, for shares from 0 to 1


class GainScheduleParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The high gains, and where they hold.

    Chosen on flights without pictures, seeds 40 to 59: nominal, gusts of 1 m/s, 200 ms told as 67, full tilt 25 degrees
    told 20; docs/log/control.md#gains-in-gusts.

    Parameters
    ----------
    weight : float
        Largest share w_0 of the high gains, 0 ... 1; 0: the low ones hold, as in long chains.
    delay, longest_delay : float
        Up to the first delay t_0 they hold, from the second one t_1 on they do not, s. More holds tighter with old
        pictures, until the loop oscillates.
    proportional, derivative, output_limit, max_error : float
        Of `FollowerParameters.horizontal`. More is held tighter in gusts, and needs a vehicle and a delay that are
        known better.
    horizontal_share, vertical_share : float
        Share of fast changes of the neighbor's speed that is flown along, level and upward, see
        `FeedforwardParameters.high_frequency_gain`. With 1 it does not matter what speed vehicle and neighbor are
        believed to have in common.
    vertical_drift_feedforward : float
        Share of the neighbor's vertical acceleration that is flown at once.
    max_stick : float
        Largest roll and pitch stick, 0 ... 1. Less leaves the flight controller a margin, and is blown away sooner.
    start_time, full_time : float
        Time after lift-off at which the high gains begin to count, and from which on they count in full, s. More gives
        the throttle that hovers longer to be found.
    forgetting_rate : float
        How fast the shortest delay of late is forgotten, s/s: pictures may be lost meanwhile. Estimate.
    """

    weight: float = 1.0
    delay: float = 0.14
    longest_delay: float = 0.25
    proportional: float = 7.0
    derivative: float = 4.5
    output_limit: float = 4.0
    max_error: float = 0.8
    horizontal_share: float = 0.9
    vertical_share: float = 0.9
    vertical_drift_feedforward: float = 0.9
    max_stick: float = 1.0
    start_time: float = 3.0
    full_time: float = 6.0
    forgetting_rate: float = 0.02

    def __post_init__(self) -> None:
        require_share(self, ("weight", "horizontal_share", "vertical_share", "max_stick"))
        require_not_negative(self, ("proportional", "derivative", "vertical_drift_feedforward", "delay", "start_time"))
        require_positive(self, ("output_limit", "max_error", "forgetting_rate"))
        require(self, ("longest_delay",), lambda value: self.delay < value < math.inf, "above delay")
        require(self, ("full_time",), lambda value: self.start_time < value < math.inf, "above start_time")


class Gains(NamedTuple):
    """Gains of a follower.

    Attributes
    ----------
    horizontal : PidParameters
        Of both level axes.
    horizontal_feedforward, vertical_feedforward : FeedforwardParameters
    vertical_drift_feedforward : float
        Share of the neighbor's vertical acceleration.
    max_stick : float
        Largest roll and pitch stick.
    """

    horizontal: PidParameters
    horizontal_feedforward: FeedforwardParameters
    vertical_feedforward: FeedforwardParameters
    vertical_drift_feedforward: float = 0.0
    max_stick: float = 1.0


class GainSchedule:
    """Chooses the gains by the shortest delay of late.

    Parameters
    ----------
    low : Gains
        For long delays and long chains.
    parameters : GainScheduleParameters, optional
        The high ones.

    Attributes
    ----------
    gains : Gains
        That hold now; the low ones before a delay is known.
    """

    def __init__(self, low: Gains, parameters: GainScheduleParameters | None = None) -> None:
        self.parameters = parameters or GainScheduleParameters()
        self._table = [interpolated(low, self.parameters, k / (ENTRIES - 1)) for k in range(ENTRIES)]
        self.gains, self._delay = self._table[0], math.inf

    def update(self, delay: float, step: float, airborne_time: float) -> Gains:
        """Choose the gains.

        Parameters
        ----------
        delay : float
            From the exposure of the last picture to the effect of the command that is computed now, s.
        step : float
            Time since the last update, s.
        airborne_time : float
            Time since lift-off, s; -inf before.
        """
        limits = self.parameters
        self._delay = min(self._delay + step * limits.forgetting_rate, delay)
        quick = clip((limits.longest_delay - self._delay) / (limits.longest_delay - limits.delay), 0.0, 1.0)
        known = clip((airborne_time - limits.start_time) / (limits.full_time - limits.start_time), 0.0, 1.0)
        self.gains = self._table[round(limits.weight * quick * known * (ENTRIES - 1))]
        return self.gains


def interpolated(low: Gains, high: GainScheduleParameters, share: float) -> Gains:
    """Interpolate between the low gains and the high ones, of which there is a share, 0 ... 1."""

    def between(one: float, other: float) -> float:
        return (
            one if share == 0.0 else other if share == 1.0 else (1.0 - share) * one + share * other
        )  # may be infinite

    level, pace, rise = low.horizontal, low.horizontal_feedforward, low.vertical_feedforward
    replace = msgspec.structs.replace
    return Gains(
        replace(
            level,
            proportional=between(level.proportional, high.proportional),
            derivative=between(level.derivative, high.derivative),
            output_limit=between(level.output_limit, high.output_limit),
            max_error=between(level.max_error, high.max_error),
        ),
        replace(pace, high_frequency_gain=between(pace.high_frequency_gain, high.horizontal_share)),
        replace(rise, high_frequency_gain=between(rise.high_frequency_gain, high.vertical_share)),
        between(low.vertical_drift_feedforward, high.vertical_drift_feedforward),
        between(low.max_stick, high.max_stick),
    )

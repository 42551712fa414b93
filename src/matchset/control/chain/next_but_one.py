"""A place held beside two balls, for long chains: `NextButOne`.

A follower that knows its neighbor alone enlarges what its neighbor does wrong, and so does the one behind it. The ball
of the vehicle that the neighbor follows says where the neighbor should be: `spacing` behind it. What is controlled is
a mixture of the two,

    b = (1 - s) b1 + s (b2 + spacing * back - rise * up),

b1 the neighbor's ball, b2 the next but one, `back` the level direction of the marker on b1, s the share. So the share
s of the neighbor's own error is not followed. With a gain T of one follower at its worst frequency, errors of a chain
grow by the root of ``q^2 = T ((1 - s) q + s)`` per vehicle and no longer by T; and b2 moves before b1 does, which takes
from T as well.
"""

import math
from collections.abc import Sequence

import msgspec

from matchset.control.ego_motion import EgoState
from matchset.control.neighbor_filter import NeighborFilter
from matchset.control.neighbor_model import AxisForecast, Forecast, NeighborFilterParameters
from matchset.control.parameter_checks import require, require_positive, require_share
from matchset.localization.pose import Pose


class NextButOneParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How much the next-but-one ball counts.

    Parameters
    ----------
    share : float
        Share s of the place that is held beside the next-but-one ball, 0 ... 1; 0: it is not looked for. More follows
        less of what the neighbor does wrong, and is farther from the neighbor for it. Chosen by: chains of ten without
        pictures, seeds 0 to 4, 0.2 to 0.3.
    spacing : float
        From the next-but-one ball back to the neighbor's when that vehicle holds its place, m. Derived: `heading` of
        the set place, and 0.05 m from a ball forward to the camera below it.
    rise : float
        How much higher the neighbor's ball is then, m. Derived: `height` of the set place plus 0.19 m from a camera up
        to its ball.
    fade : float
        Time in which the share comes and goes, s, when that ball comes into sight or is hidden: the set place must not
        jump. Estimate.
    memory : float
        How long after its last pose that ball counts, s. Estimate.
    """

    share: float = 0.0
    spacing: float = 1.55
    rise: float = 0.0
    fade: float = 0.3
    memory: float = 0.3

    def __post_init__(self) -> None:
        require_share(self, ("share",))
        require_positive(self, ("spacing", "fade", "memory"))
        require(self, ("rise",), math.isfinite, "finite")


class NextButOne:
    """Filters the next-but-one ball, and mixes it with the neighbor's.

    Parameters
    ----------
    parameters : NextButOneParameters, optional
    motion : NeighborFilterParameters, optional
        Of the filter.

    Attributes
    ----------
    ball : NeighborFilter
        Of the next-but-one ball.
    weight : float
        Share of `NextButOneParameters.share` that counts now, 0 ... 1.
    """

    def __init__(
        self, parameters: NextButOneParameters | None = None, motion: NeighborFilterParameters | None = None
    ) -> None:
        self.parameters = parameters or NextButOneParameters()
        self.ball = NeighborFilter(motion)
        self.weight, self._time = 0.0, -math.inf

    def update(self, pose: Pose, own: EgoState) -> None:
        """Note where the next-but-one ball is.

        Parameters
        ----------
        pose : Pose
            In the vehicle's frame.
        own : EgoState
            The vehicle by dead reckoning when the picture was taken.
        """
        self.ball.update(pose, own)

    def at_times(self, neighbor: NeighborFilter, times: Sequence[float], max_extrapolation: float) -> list[Forecast]:
        """Predict the mixture, as `NeighborFilter.at_times` does the neighbor; exactly that while the weight is 0.

        Parameters
        ----------
        neighbor : NeighborFilter
        times : sequence of float
            s; the first one is later than in the last call.
        max_extrapolation : float
            s.
        """
        first = neighbor.at_times(times, max_extrapolation)
        step = max(times[0] - self._time, 0.0) if self._time > -math.inf else 0.0
        self._time = times[0]
        seen = times[0] - self.ball.time <= self.parameters.memory + max_extrapolation
        self.weight = min(max(self.weight + (step if seen else -step) / self.parameters.fade, 0.0), 1.0)
        share = self.weight * self.parameters.share
        if share == 0.0 or self.ball.time == -math.inf:
            return first
        second = self.ball.at_times(times, max_extrapolation)
        return [self._mixed(near, far, share) for near, far in zip(first, second, strict=True)]

    def _mixed(self, near: Forecast, far: Forecast, share: float) -> Forecast:
        """Mix the forecasts of two balls for one time; the yaw is that of the neighbor's."""
        spacing, angle = self.parameters.spacing, near.yaw.value
        return Forecast(
            _mixed_axis(near.x, far.x, spacing * math.sin(angle), share),
            _mixed_axis(near.y, far.y, -self.parameters.rise, share),
            _mixed_axis(near.z, far.z, spacing * math.cos(angle), share),
            near.yaw,
        )


def _mixed_axis(near: AxisForecast, far: AxisForecast, offset: float, share: float) -> AxisForecast:
    rest = 1.0 - share
    return AxisForecast(
        rest * near.value + share * (far.value + offset),
        rest * near.speed + share * far.speed,
        rest * near.oscillation_acceleration + share * far.oscillation_acceleration,
        rest * near.drift_acceleration + share * far.drift_acceleration,
    )

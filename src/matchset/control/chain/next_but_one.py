"""A place held beside two balls, for long chains: `NextButOne`.

A follower that knows its neighbor alone enlarges what its neighbor does wrong, and so does the one behind it. The ball
of the vehicle that the neighbor follows moves before the neighbor's does, and not as the neighbor errs. What is
controlled is a mixture of the two,

    b = b1 + s H (b2 - b1),

b1 the neighbor's ball, b2 the next but one, s the share, and H what passes fast motion alone: a steady distance and a
steady drift of it count for nothing, so neither the range of a ball that is half hidden nor the way in which a
neighbor turns about the other moves the set place. With a gain T of one follower at its worst frequency, errors of a
chain grow there by the root of ``q^2 = T ((1 - s) q + s)`` per vehicle and no longer by T.
"""

import math
from collections.abc import Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.chain.slow_part import SlowPart
from matchset.control.ego_motion import EgoState
from matchset.control.neighbor_filter import VALUES, NeighborFilter, named
from matchset.control.neighbor_model import AXES, YAW, Forecast, NeighborFilterParameters
from matchset.localization.pose import Pose
from matchset.numeric.arguments import require, require_positive, require_share
from matchset.numeric.jit import kernel

Floats = npt.NDArray[np.float64]


class NextButOneParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How much the next-but-one ball counts.

    Parameters
    ----------
    share : float
        Share s of the fast motion of the next-but-one ball that is followed in place of the neighbor's, 0 ... 1; 0: it
        is not looked for. More follows less of what the neighbor does wrong, and is farther from the neighbor for it.
        Chosen by: chains of ten and of three, seeds 0 to 4, docs/log/control.md#next-but-one.
    time_constant : float
        Time T of H = s^2 / (s + 1 / T)^2, s: what takes longer counts for nothing. More helps longer chains, and costs
        a follower next to the rope more, whose neighbor moves to the side as the rope's vehicle turns. Chosen by the
        same flights. For a delay, from exposure to the effect of a command, of `reference_delay`; it grows with that to
        the power of `delay_exponent`, up to `max_time_constant`, as slower motion is enlarged then.
    reference_delay : float
        That delay, s: what `time_constant` was chosen with.
    delay_exponent : float
        See `time_constant`. Chosen by: chains of ten at 67 and 133 ms, seeds 0 and 1.
    max_time_constant : float
        Longest T, s; where it should be longer, the share is less in proportion. More costs a follower next to the rope
        more. Chosen by: three with 200 ms told as 67, and ten with 133 ms, seeds 0 to 2 and 40 to 59.
    forgetting_rate : float
        How fast the shortest delay of late is forgotten, s/s: pictures may be lost meanwhile. Estimate.
    spacing : float
        From the next-but-one ball back to the neighbor's when that vehicle holds its place, m: where it is looked for.
        Derived: `heading` of the set place, and 0.05 m from a ball forward to the camera below it.
    height_difference : float
        How much higher the neighbor's ball is then, m. Derived: `height` of the set place plus 0.19 m from a camera up
        to its ball.
    fade_time : float
        Time in which the share comes and goes, s, when that ball comes into sight or is hidden: the set place must not
        jump. Estimate.
    pose_timeout : float
        How long after its last pose that ball counts, s. Estimate.
    local_search_time : float
        How long after its last pose it is looked for where it was seen, and not where it should be, s. Estimate.
    """

    share: float = 0.3
    time_constant: float = 0.3
    reference_delay: float = 0.097
    delay_exponent: float = 3.0
    max_time_constant: float = 1.5
    forgetting_rate: float = 0.02
    spacing: float = 1.55
    height_difference: float = 0.0
    fade_time: float = 0.3
    pose_timeout: float = 0.3
    local_search_time: float = 0.5

    def __post_init__(self) -> None:
        require_share(self, ("share",))
        require_positive(
            self,
            (
                "time_constant",
                "reference_delay",
                "delay_exponent",
                "max_time_constant",
                "forgetting_rate",
                "spacing",
                "fade_time",
                "pose_timeout",
                "local_search_time",
            ),
        )
        require(self, ("height_difference",), math.isfinite, "finite")


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
        self._apart, self._delay = SlowPart(self.parameters.time_constant), math.inf
        self._slow = np.zeros((2, YAW))  # values and speeds of the slow part
        empty = np.zeros((1, AXES, VALUES))
        mix(empty, empty, 0.0, np.zeros(1), self._slow)  # compiles it

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

    def is_followed(self, time: float) -> bool:
        """Whether that ball was seen so lately that it is looked for where it was seen."""
        return time - self.ball.time <= self.parameters.local_search_time

    def expected(self, neighbor: NeighborFilter, own: EgoState, time: float, max_extrapolation: float) -> Floats:
        """Predict where that ball is.

        While it is followed, the direction is that in which it was seen. The distance never is: an arc says little of
        it, and a guess that rests on a guess would drift.

        Parameters
        ----------
        neighbor : NeighborFilter
        own : EgoState
            The vehicle then.
        time : float
            s.
        max_extrapolation : float
            s.

        Returns
        -------
        ndarray of shape (3,), float64
            m, in the frame at rest.
        """
        near, limits = neighbor.at(time, max_extrapolation), self.parameters
        x, z = math.sin(near.yaw.value), math.cos(near.yaw.value)  # back
        place: Floats = np.array(
            (
                near.x.value - limits.spacing * x,
                near.y.value + limits.height_difference,
                near.z.value - limits.spacing * z,
            )
        )
        if not self.is_followed(time):
            return place
        seen = self.ball.at(time, max_extrapolation).place - own.position
        away = place - own.position
        expected: Floats = own.position + seen * math.sqrt((away @ away) / (seen @ seen))
        return expected

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
        asked = np.array(times, dtype=np.float64)
        first = neighbor.numbers_at(asked, max_extrapolation)
        step = max(times[0] - self._time, 0.0) if self._time > -math.inf else 0.0
        self._time = times[0]
        seen = times[0] - self.ball.time <= self.parameters.pose_timeout + max_extrapolation
        self.weight = min(max(self.weight + (step if seen else -step) / self.parameters.fade_time, 0.0), 1.0)
        share = self.weight * self.parameters.share
        if share == 0.0 or self.ball.time == -math.inf:
            self._apart.forget()
            return named(first)
        second = self.ball.numbers_at(asked, max_extrapolation)
        self._delay = min(self._delay + step * self.parameters.forgetting_rate, times[0] - neighbor.time)
        limits = self.parameters
        wanted = limits.time_constant * (self._delay / limits.reference_delay) ** limits.delay_exponent
        self._apart.time = min(wanted, limits.max_time_constant)
        share *= self._apart.time / wanted
        self._apart.update((second[0, :YAW, 0] - first[0, :YAW, 0]).tolist(), step)
        self._slow[0], self._slow[1] = self._apart.values, self._apart.speeds
        mix(first, second, share, asked, self._slow)
        return named(first)


@kernel(refcount=False)
def mix(near: Floats, far: Floats, share: float, times: Floats, slow: Floats) -> None:
    """Mix the forecasts of two balls, (n, 4, 4), into those of the first; the yaw stays the neighbor's.

    `slow` is the slow part of the distance of the two at the first time, and its speed, (2, 3).
    """
    rest = 1.0 - share
    for k in range(near.shape[0]):
        for axis in range(YAW):
            one, other = near[k, axis], far[k, axis]
            slow_value = slow[0, axis] + (times[k] - times[0]) * slow[1, axis]
            one[0] = rest * one[0] + share * (other[0] - slow_value)
            one[1] = rest * one[1] + share * (other[1] - slow[1, axis])
            for value in range(2, one.shape[0]):
                one[value] = rest * one[value] + share * other[value]

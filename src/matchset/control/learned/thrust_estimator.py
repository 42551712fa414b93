"""Thrust per throttle, estimated in flight: `ThrustEstimator`.

How much throttle hovers depends on mass, motors and battery. A Kalman filter with an augmented state (Bar-Shalom, Li &
Kirubarajan 2001, section 11.9) estimates it from the height above the neighbor's ball: with the throttle u that the
motors have reached, the throttle h that was told to hover, and gravity g over the ratio of moved to carried mass,

    height'' = g (k u cos(tilt) / h - 1) + w,     k' = n,

w and n white noise. The gain k is 1 where the vehicle is as told, and h / k hovers. It is observed while the vehicle
flies only: a hand or the ground would be taken for thrust.
"""

import math

import msgspec
import numpy as np

from matchset.numeric.arguments import require, require_at_least, require_positive
from matchset.numeric.kalman import predict, update


class ThrustEstimatorParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Parameters of a `ThrustEstimator`.

    Chosen on flights without pictures of seeds 100 to 102 with thrust and mass 20 % off, and in chains of ten:
    docs/log/control.md#nobody-measured.

    Parameters
    ----------
    initial_sigma : float
        Standard deviation of the gain at the start, no unit. More learns a wrong hover throttle sooner, and takes more
        of the neighbor's motion in the first second for thrust.
    gain_noise : float
        How fast the gain may change, no unit per root of s. More follows a battery that sags, less is calmer in a long
        chain.
    acceleration_noise : float
        Root of the spectral density of the acceleration of the neighbor and of gusts, m/s^2 per root of Hz. More trusts
        the height less.
    height_sigma : float
        Standard deviation of a height, m: the tilt of the vehicle is known by dead reckoning only. More is calmer.
    airborne_ratio : float
        Share of the throttle that was told to hover, from which on the vehicle is taken to fly. Less begins in the
        hand; more falls farther before it begins.
    lift_lags : float
        How long after a throttle of that share begins to act the vehicle is taken to have lifted off, time constants of
        the thrust. Less tilts it in the hand, where the integrals of a flight controller wind up; more lets it drift.
    release_sigma : float
        Standard deviation of the speed that it then has, m/s: the hand lets go a little sooner or later.
    min_gain, max_gain : float
        Limits of the gain: 0.45 is all of the throttle where 0.45 was told. Wider limits fly vehicles that are known
        less, and know an empty battery; narrower ones bound what a wrong pose can do.
    """

    initial_sigma: float = 0.25
    gain_noise: float = 0.03
    acceleration_noise: float = 1.0
    height_sigma: float = 0.05
    airborne_ratio: float = 0.7
    lift_lags: float = 2.0
    release_sigma: float = 0.3
    min_gain: float = 0.45
    max_gain: float = 1.7

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)
        require(self, ("min_gain",), lambda value: value <= 1.0, "at most 1")
        require_at_least(self, 1, "max_gain")


class ThrustEstimator:
    """Estimates the thrust per throttle of one vehicle. The constructor compiles all kernels.

    Parameters
    ----------
    hover_throttle : float
        Throttle that is told to hover.
    gravity : float
        Over the ratio of moved to carried mass, m/s^2.
    delay : float
        From sending a throttle to its first effect, s.
    lag : float
        Time constant of the thrust, s.
    parameters : ThrustEstimatorParameters, optional

    Attributes
    ----------
    delay : float
        From sending a throttle to its first effect, s.
    gain : float
        k, no unit: thrust per throttle over what was told, within the limits.
    lift_time : float
        When the vehicle lifts off by the throttles that were sent since the last `reset`, s; inf if it does not.
    """

    def __init__(
        self,
        hover_throttle: float,
        gravity: float,
        delay: float,
        lag: float,
        parameters: ThrustEstimatorParameters | None = None,
    ) -> None:
        self.parameters = parameters or ThrustEstimatorParameters()
        self._hover, self._gravity, self.delay, self._lag = hover_throttle, gravity, delay, lag
        self._transition, self._noise = np.eye(3), np.zeros((3, 3))
        self._observation, self._measured = np.array(((1.0, 0.0, 0.0),)), np.zeros(1)
        self._variance = np.full((1, 1), self.parameters.height_sigma**2)
        self.reset()
        self._predict(1.0, 0.0, 0.0, 0.0)  # compiles what it calls
        self._correct(0.0)
        self.reset()

    def reset(self) -> None:
        """Forget everything: the motors stand still."""
        self.gain = 1.0
        self._state = np.array((0.0, 0.0, self.gain))
        self._covariance = np.diag((0.0, 0.0, self.parameters.initial_sigma**2))
        self._waiting: list[tuple[float, float]] = []
        self._throttle = self._reached = 0.0
        self._time = self._begin = -math.inf
        self.lift_time = math.inf

    @property
    def sigma(self) -> float:
        """Standard deviation of the gain."""
        return math.sqrt(max(float(self._covariance[2, 2]), 0.0))

    @property
    def airborne(self) -> bool:
        """Whether the thrust has sufficed to fly since the last `reset`."""
        return self._begin > -math.inf

    def sent(self, throttle: float, now: float) -> None:
        """Note a throttle that was sent, 0 ... 1, and when, s."""
        self._waiting.append((now, throttle))
        if self.lift_time == math.inf and throttle >= self.parameters.airborne_ratio * self._hover:
            self.lift_time = now + self.delay + self.parameters.lift_lags * self._lag

    def update(self, height: float, upright: float, time: float) -> None:
        """Correct by a height above the neighbor's ball.

        Parameters
        ----------
        height : float
            m, from whatever level.
        upright : float
            Cosine of the tilt: the share of the thrust that lifts.
        time : float
            When it was seen, s; earlier than before: nothing happens.
        """
        if not time > self._time:
            return
        step, speed, way = self._pass(time)
        if not self.airborne and self._reached >= self.parameters.airborne_ratio * self._hover:
            self._begin = time
            self._covariance[1, 1] += self.parameters.release_sigma**2
        if self.airborne:
            self._predict(step, speed * upright, way * upright, self._gravity)
        elif step > 0.0:
            self._predict(step, 0.0, 0.0, 0.0)
        else:
            self._state[0], self._covariance[0, 0] = height, self._variance[0, 0]
            self._covariance[1, 1] = self.parameters.release_sigma**2
            return
        self._correct(height)

    def _correct(self, height: float) -> None:
        """Correct the prediction by a height, and keep the gain within its limits."""
        self._measured[0] = height - self._state[0]
        update(self._state, self._covariance, self._measured, self._observation, self._variance, math.inf)
        self.gain = min(max(float(self._state[2]), self.parameters.min_gain), self.parameters.max_gain)
        self._state[2] = self.gain

    def _predict(self, step: float, speed: float, way: float, gravity: float) -> None:
        """Predict over a step in which a gain of 1 gives a speed and a way."""
        parameters, state = self.parameters, self._state
        self._transition[0, 1] = step
        self._transition[0, 2], self._transition[1, 2] = way, speed
        density = parameters.acceleration_noise**2
        self._noise[0, 0], self._noise[1, 1] = density * step**3 / 3.0, density * step
        self._noise[0, 1] = self._noise[1, 0] = density * step**2 / 2.0
        self._noise[2, 2] = parameters.gain_noise**2 * step if gravity > 0.0 else 0.0
        predict(state, self._covariance, self._transition, self._noise)
        state[0] -= 0.5 * gravity * step**2
        state[1] -= gravity * step

    def _pass(self, time: float) -> tuple[float, float, float]:
        """Let the thrust follow the throttles until a time: step, and speed and way that a gain of 1 gives."""
        start = at = self._time if self._time > -math.inf else time
        speed = way = 0.0
        scale = self._gravity / self._hover
        while at < time:
            while self._waiting and self._waiting[0][0] + self.delay <= at:
                self._throttle = self._waiting.pop(0)[1]
            until = min(time, self._waiting[0][0] + self.delay) if self._waiting else time
            part = until - at
            fade = math.exp(-part / self._lag)
            middle = self._throttle + (self._reached - self._throttle) * math.exp(-0.5 * part / self._lag)
            self._reached = self._throttle + (self._reached - self._throttle) * fade
            way += speed * part + 0.5 * scale * middle * part**2
            speed += scale * middle * part
            at = until
        self._time = time
        return time - start, speed, way

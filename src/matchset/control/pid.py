"""A PID controller with named terms: `Pid`."""

import math
from typing import NamedTuple

import msgspec

from matchset.control.command import clip
from matchset.numeric.arguments import require, require_not_negative, require_share


class PidParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Gains and limits of a `Pid`; units are those of its output per unit of its input.

    Defaults switch a part off. The values that are flown, and what chose them, are in `FollowerParameters`. The key in
    a file is in parentheses where it is another one.

    Parameters
    ----------
    proportional : float
        Gain P, per unit of error. More holds tighter, until the delay makes the loop oscillate.
    integral : float
        Gain I, per unit of error and s. More removes a constant disturbance sooner, and overshoots.
    derivative : float
        Gain D, per unit of error per s. More damps, and amplifies noise.
    derivative_filter_time : float
        Time constant of the low-pass filter of the derivative, s; 0 for none.
    max_error : float
        Limit of the error. From farther away the goal is approached at the speed ``P max_error / D``.
    output_limit : float
        Limit of the output.
    integral_limit : float
        Limit of the integral term.
    integral_zone : float
        Largest error for which the integral changes: the error of a long approach says nothing about a bias.
    integral_lead : float
        The integral adds up the error predicted so far ahead, s. With D/P an approach as P and D want it adds nothing,
        so that it is not mistaken for a bias.
    integral_decay_time : float
        The integral's gain decays with this time constant while the error is in the zone, s.
    integral_floor : float
        Share of the integral's gain that remains at the end, 0 ... 1. Less leaves slow motion to the other terms, more
        follows a bias that changes.
    """

    proportional: float
    integral: float = 0.0
    derivative: float = 0.0
    derivative_filter_time: float = 0.0
    max_error: float = math.inf
    output_limit: float = math.inf
    integral_limit: float = math.inf
    integral_zone: float = math.inf
    integral_lead: float = 0.0
    integral_decay_time: float = math.inf
    integral_floor: float = 0.0

    def __post_init__(self) -> None:
        require_not_negative(
            self, ("proportional", "integral", "derivative", "derivative_filter_time", "integral_lead")
        )
        limits = ("max_error", "output_limit", "integral_limit", "integral_zone", "integral_decay_time")
        require(self, limits, lambda value: value > 0.0, "positive")
        require_share(self, ("integral_floor",))


class PidTerms(NamedTuple):
    """Terms of the last output; `output` is their sum within the limit."""

    proportional: float = 0.0
    integral: float = 0.0
    derivative: float = 0.0
    output: float = 0.0


class Pid:
    """u = P e + I integral((e - L dy/dt) dt) - D dy/dt, with the error e = goal - y and the integral's lead L.

    The derivative is that of the measurement y, so that a new goal causes no jump; it is low-passed. While the output
    is at its limit the integral does not grow further in that direction (anti-windup). The integral's gain is large at
    first and decays.

    Parameters
    ----------
    parameters : PidParameters

    Attributes
    ----------
    terms : PidTerms
        Of the last update.
    """

    def __init__(self, parameters: PidParameters) -> None:
        self.parameters = parameters
        self.terms = PidTerms()
        self._last: float | None = None
        self._rate = self._time_in_zone = 0.0

    def reset(self, keep_integral: bool = False) -> None:
        """Forget the past; with `keep_integral` all but the integral term, whose bias still holds."""
        self.terms = PidTerms(integral=self.terms.integral if keep_integral else 0.0)
        self._time_in_zone = self._time_in_zone if keep_integral else 0.0
        self._last, self._rate = None, 0.0

    def update(self, goal: float, measured: float, step: float, rate: float | None = None) -> float:
        """Compute the output for a measurement.

        Parameters
        ----------
        goal, measured : float
        step : float
            Time since the last update, s.
        rate : float, optional
            dy/dt where something else measures it; otherwise the difference quotient.

        Returns
        -------
        float
            The output, within -output_limit ... output_limit.

        Raises
        ------
        ValueError
            If a number is not finite or the step not positive.
        """
        if not (math.isfinite(goal) and math.isfinite(measured) and 0.0 < step < math.inf):
            raise ValueError(f"a controller needs numbers, got goal {goal}, measured {measured}, step {step}")
        gains = self.parameters
        self._update_rate(measured, step, rate)
        error = goal - measured
        limited = clip(error, -gains.max_error, gains.max_error)
        proportional, derivative = gains.proportional * limited, -gains.derivative * self._rate
        integral = self._next_integral(error, limited, step)
        total = proportional + integral + derivative
        if abs(total) > gains.output_limit and total * error > 0.0:
            integral = self.terms.integral
            total = proportional + integral + derivative
        output = clip(total, -gains.output_limit, gains.output_limit)
        self.terms = PidTerms(proportional, integral, derivative, output)
        return output

    def _update_rate(self, measured: float, step: float, rate: float | None) -> None:
        """Low-pass the derivative of the measurement."""
        if rate is None:
            rate = 0.0 if self._last is None else (measured - self._last) / step
        elif not math.isfinite(rate):
            raise ValueError(f"a controller needs numbers, got rate {rate}")
        first = self._last is None
        self._last = measured
        lag = self.parameters.derivative_filter_time
        self._rate = rate if first else self._rate + (rate - self._rate) * step / (lag + step)

    def _next_integral(self, error: float, limited: float, step: float) -> float:
        """Return the integral term one step later, within its limit."""
        gains, integral = self.parameters, self.terms.integral
        if abs(error) <= gains.integral_zone:
            self._time_in_zone += step
            decay = max(math.exp(-self._time_in_zone / gains.integral_decay_time), gains.integral_floor)
            integral += decay * gains.integral * (limited - gains.integral_lead * self._rate) * step
        return clip(integral, -gains.integral_limit, gains.integral_limit)

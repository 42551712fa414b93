"""A controller whose terms can be looked at: `Pid`."""

import math
from typing import NamedTuple

import msgspec


class PidParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Gains of a `Pid`; units are those of its output per unit of its input.

    Parameters
    ----------
    proportional : float
        Per unit of error. More holds tighter, until delay makes it swing.
    integral : float
        Per unit of error and s. More forgets constant disturbances sooner, and overshoots.
    derivative : float
        Per unit of error per s. More damps, and passes on noise.
    smoothing : float
        Time constant of the low-pass on the derivative, s; 0 for none.
    stride : float
        Largest error that counts. What is farther off is approached at a speed of ``P stride / D`` and no faster.
    most : float
        Largest output.
    most_integral : float
        Largest integral term.
    within : float
        Error up to which the integral grows; a long way to go teaches nothing about a bias, and makes it overshoot.
    foresight : float
        How far ahead the error is that the integral takes up, s: with D/P an approach as P and D want it adds nothing,
        so a way to go is not mistaken for a bias, and a bias shows before the way is done.
    learning : float
        Time near the goal after which the integral is nearly learned, s: its gain falls to 37 % in so long.
    settled : float
        Share of the integral's gain that remains for good, 0 ... 1. Less leaves slow motion to the other terms, more
        keeps up with a bias that changes.
    """

    proportional: float
    integral: float = 0.0
    derivative: float = 0.0
    smoothing: float = 0.0
    stride: float = math.inf
    most: float = math.inf
    most_integral: float = math.inf
    within: float = math.inf
    foresight: float = 0.0
    learning: float = math.inf
    settled: float = 0.0

    def __post_init__(self) -> None:
        for name in ("proportional", "integral", "derivative", "smoothing", "foresight"):
            if not 0.0 <= getattr(self, name) < math.inf:
                raise ValueError(f"{name} must not be negative, got {getattr(self, name)}")
        for name in ("stride", "most", "most_integral", "within", "learning"):
            if not getattr(self, name) > 0.0:
                raise ValueError(f"{name} must be positive, got {getattr(self, name)}")
        if not 0.0 <= self.settled <= 1.0:
            raise ValueError(f"settled must be within 0 ... 1, got {self.settled}")


class PidTerms(NamedTuple):
    """What the last output was made of; `output` is their sum within the limit."""

    proportional: float = 0.0
    integral: float = 0.0
    derivative: float = 0.0
    output: float = 0.0


class Pid:
    """u = P e + I integral((e - F dy/dt) dt) - D dy/dt, with e = goal - y and the foresight F.

    The derivative is that of the measurement y, so a new goal does not kick; it is low-passed. While the output is at
    its limit the integral does not grow further that way. The integral learns fast at first, and slower later.

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
        self._rate = self._age = 0.0

    def reset(self, keep_integral: bool = False) -> None:
        """Forget the past, on request all but the integral term: what it learned of a bias still holds."""
        self.terms = PidTerms(integral=self.terms.integral if keep_integral else 0.0)
        self._age = self._age if keep_integral else 0.0
        self._last, self._rate = None, 0.0

    def update(self, goal: float, measured: float, step: float, rate: float | None = None) -> float:
        """ControlOutput to a measurement.

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
            The output, within -most ... most.

        Raises
        ------
        ValueError
            If a number is not finite or the step not positive.
        """
        if not (math.isfinite(goal) and math.isfinite(measured) and 0.0 < step < math.inf):
            raise ValueError(f"a controller needs numbers, got goal {goal}, measured {measured}, step {step}")
        gains = self.parameters
        if rate is None:
            rate = 0.0 if self._last is None else (measured - self._last) / step
        elif not math.isfinite(rate):
            raise ValueError(f"a controller needs numbers, got rate {rate}")
        fresh = self._last is None
        self._last = measured
        self._rate = rate if fresh else self._rate + (rate - self._rate) * step / (gains.smoothing + step)
        error = goal - measured
        near = min(max(error, -gains.stride), gains.stride)
        proportional, derivative = gains.proportional * near, -gains.derivative * self._rate
        integral = self.terms.integral
        if abs(error) <= gains.within:
            self._age += step
            learning = max(math.exp(-self._age / gains.learning), gains.settled)
            integral += learning * gains.integral * (near - gains.foresight * self._rate) * step
        integral = min(max(integral, -gains.most_integral), gains.most_integral)
        total = proportional + integral + derivative
        if abs(total) > gains.most and total * error > 0.0:
            integral = self.terms.integral
            total = proportional + integral + derivative
        output = min(max(total, -gains.most), gains.most)
        self.terms = PidTerms(proportional, integral, derivative, output)
        return output

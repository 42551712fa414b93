"""How long and how bright the pictures of a flying camera are exposed: `Exposures`."""

import math

import msgspec
import numpy as np

from matchset.sim.conditions.conditions import Conditions
from matchset.sim.rendering.shutter import channel_gain


class ExposureParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How finely blur is sampled, and how lamps flicker.

    Parameters
    ----------
    spacing : int
        Steps of the world between two sub-exposures, at most. Less: smoother blur, slower. Chosen by hand: 4 ms, 2.3 px
        at 100 degrees a second; an analog link shows no more.
    flicker_hz : float
        How often a lamp on mains of 50 Hz is bright, Hz.
    """

    spacing: int = 2
    flicker_hz: float = 100.0


class Exposures:
    """When and with which gain fields and pictures are exposed.

    Parameters
    ----------
    conditions : Conditions
    rate : int
        Steps of the world per second.
    seed : int
        Decides the phase of the lamps.
    parameters : ExposureParameters, optional

    Attributes
    ----------
    half : int
        Steps from the middle of an exposure to its end.
    """

    def __init__(
        self, conditions: Conditions, rate: int, seed: int, parameters: ExposureParameters | None = None
    ) -> None:
        self.parameters = parameters or ExposureParameters()
        self._rate, self._flicker, self._swing = rate, conditions.flicker, conditions.exposure_swing
        self._duration = 1e-3 * conditions.blur_ms
        self.half = half_exposure(conditions.blur_ms, rate)
        self._phase = float(np.random.default_rng((seed, 0xF11C)).uniform(0.0, 2.0 * math.pi))

    def steps(self, middle: int) -> list[int]:
        """Return the steps whose pictures, averaged, are the exposure that has its middle at a step."""
        long = self._duration * self._rate
        count = max(math.ceil(long / self.parameters.spacing), 1)
        return [middle + round(long * ((k + 0.5) / count - 0.5)) for k in range(count)]

    def field_gain(self, middle: int) -> float:
        """Return the brightness of a field whose exposure has its middle at a step: lamps, in the mean over it."""
        if not self._flicker:
            return 1.0
        turns = self.parameters.flicker_hz * middle / self._rate
        share = float(np.sinc(self.parameters.flicker_hz * self._duration))
        return 1.0 + self._flicker * share * math.cos(2.0 * math.pi * turns + self._phase)

    def gain(self, middle: int) -> tuple[float, float, float]:
        """Return the gain of B, G and R that the camera has chosen for a picture."""
        return channel_gain(middle / self._rate, self._swing, 0.0)


def half_exposure(blur_ms: float, rate: int) -> int:
    """Return the steps of the world from the middle of an exposure to its end."""
    return math.ceil(0.5e-3 * blur_ms * rate)

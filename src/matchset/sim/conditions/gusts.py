"""Wind and gusts at the vehicles of a chain: `Gusts`."""

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.sim.conditions.conditions import Conditions

Floats = npt.NDArray[np.float64]


class Gusts:
    """Decides by a seed where the wind comes from and what drives the gusts.

    Parameters
    ----------
    conditions : Conditions
    seed : int
    air : record, written
        `matchset.sim.chain_motion.Wind`.
    step : float
        Of the world, s.
    """

    def __init__(self, conditions: Conditions, seed: int, air: Any, step: float) -> None:
        self._rng, self._blow = np.random.default_rng((seed, 0x6057)), conditions.gust_m_s > 0.0
        angle = self._rng.uniform(0.0, 2.0 * math.pi)
        air.steady[:] = conditions.wind_m_s * math.cos(angle), 0.0, conditions.wind_m_s * math.sin(angle)
        air.keep = math.exp(-step / conditions.gust_time_s)
        air.noise = conditions.gust_m_s * math.sqrt(1.0 - air.keep**2)
        air.gust[:] = conditions.gust_m_s * self._rng.standard_normal(air.gust.shape)

    def added_to(self, kicks: Floats) -> Floats:
        """Append the deviates that drive the gusts, if there are any, to (n, vehicles, 2) others."""
        return (
            np.concatenate((kicks, self._rng.standard_normal((*kicks.shape[:2], 3))), axis=2) if self._blow else kicks
        )

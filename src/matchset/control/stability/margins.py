"""Margins of a loop by its frequency response: `margins_of`, and of one that predicts: `robustness_of`."""

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
Complex = npt.NDArray[np.complex128]

TINY = 1e-300  # least magnitude of which a logarithm is taken


class Margins(NamedTuple):
    """How far a loop is from oscillating (Bode 1945).

    Attributes
    ----------
    gain_db : float
        By so much the gain may be raised, dB; inf if by any. Negative: it oscillates, and grows.
    phase_deg : float
        So much later in phase may it answer where its gain is 1, degrees; inf if its gain is nowhere 1.
    delay : float
        That phase as a time, s, at the frequency where it is shortest; inf as well.
    """

    gain_db: float
    phase_deg: float
    delay: float


def margins_of(frequencies: Floats, response: Complex, factor: float = 1.0) -> Margins:
    """Compute the margins of an open loop whose negative feedback is closed.

    The phase is followed from one frequency to the next, so that turns are not lost. The slow end must be where the
    loop integrates: its phase there is taken to be within a turn below zero.

    Parameters
    ----------
    frequencies : ndarray of shape (n,)
        Ascending, rad/s.
    response : ndarray of shape (n,), complex
    factor : float
        Of all gains.
    """
    level = np.log(np.maximum(np.abs(response), TINY) * factor)
    phase = np.unwrap(np.angle(response))
    phase -= 2.0 * math.pi * (math.floor(phase[0] / (2.0 * math.pi)) + 1)
    falling = _crossings(phase + math.pi, downward_only=True)
    gain = min((-_at(level, *each) for each in falling), default=math.inf)
    margin = delay = math.inf
    for each in _crossings(level):
        behind = math.pi + _at(phase, *each)
        margin, delay = min(margin, behind), min(delay, behind / _at(frequencies, *each))
    return Margins(_in_db(gain), math.degrees(margin), delay)


def robustness_of(frequencies: Floats, response: Complex) -> Margins:
    """Compute the margins of a loop that is known to be stable when closed, however its phase turns when it is open.

    Its own prediction may be unstable by itself. Then what counts is which change, from where it is, reaches -1 first:
    a gain that rises, a phase that moves either way, a delay.

    Parameters
    ----------
    frequencies : ndarray of shape (n,)
        Ascending, rad/s.
    response : ndarray of shape (n,), complex
    """
    level = np.log(np.maximum(np.abs(response), TINY))
    phase = np.unwrap(np.angle(response))
    gain = margin = delay = math.inf
    for turn in range(math.floor(phase.min() / (2.0 * math.pi)) - 1, math.ceil(phase.max() / (2.0 * math.pi)) + 1):
        for each in _crossings(phase - math.pi * (2 * turn + 1)):
            rise = -_at(level, *each)
            gain = min(gain, rise) if rise > 0.0 else gain
    for each in _crossings(level):
        behind = (_at(phase, *each) + math.pi) % (2.0 * math.pi)
        margin = min(margin, behind, 2.0 * math.pi - behind)
        delay = min(delay, behind / _at(frequencies, *each))
    return Margins(_in_db(gain), math.degrees(margin), delay)


def _crossings(values: Floats, downward_only: bool = False) -> list[tuple[int, float]]:
    """Where a line crosses 0: the point before, and the share of the way to the next one."""
    before, after = values[:-1], values[1:]
    crossed = (before > 0.0) & (after <= 0.0)
    if not downward_only:
        crossed |= (before <= 0.0) & (after > 0.0)
    return [(k, float(before[k] / (before[k] - after[k]))) for k in np.flatnonzero(crossed).tolist()]


def _at(values: Floats, k: int, share: float) -> float:
    return float(values[k] + share * (values[k + 1] - values[k]))


def _in_db(logarithm: float) -> float:
    return 20.0 * logarithm / math.log(10.0)

"""How the clock of a partner stands to the own one: `ClockOffset`, from exchanges as NTP makes them.

Asked at t1 on the own clock, received at t2 and answered at t3 on the partner's, back at t4: the offset is
``((t1 - t2) + (t4 - t3)) / 2``, and it is off by no more than half the round trip, ``((t4 - t1) - (t3 - t2)) / 2``
(Mills, RFC 5905). The best of several exchanges is believed; it gets worse with time, as clocks drift apart.
"""

import math
from collections import deque
from typing import NamedTuple

import msgspec

from matchset.numeric.arguments import are_finite, require_positive


class ExchangeParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How clocks are compared.

    Parameters
    ----------
    interval : float
        Time between two rounds of exchanges with a partner, s. Less costs messages, more lets the uncertainty grow.
        Chosen by hand: `drift` adds 0.2 ms in it.
    exchanges : int
        Exchanges of a round. More find a quick one on a busy network; chosen by hand.
    patience : float
        How long an answer is waited for, s. Chosen by hand: fifty times that of a slow Wi-Fi.
    drift : float
        By how much two clocks drift apart, s/s. Chosen by: 50 ppm, the largest of a common crystal, of each.
    kept : int
        Exchanges that are remembered. Chosen by hand: what `drift` makes worse than a new one is forgotten.
    """

    interval: float = 2.0
    exchanges: int = 4
    patience: float = 0.5
    drift: float = 1e-4
    kept: int = 16

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)


class Exchange(NamedTuple):
    """A question for the time, and its answer.

    Attributes
    ----------
    asked, returned : float
        On the own clock, s.
    received, answered : float
        On the clock of the partner, s.
    """

    asked: float
    received: float
    answered: float
    returned: float


class Offset(NamedTuple):
    """Own clock minus the partner's, s, and by how much that is off at most.

    Attributes
    ----------
    seconds : float
    uncertainty : float
    """

    seconds: float
    uncertainty: float


class _Measured(NamedTuple):
    """An offset, and when it was measured on the own clock, s."""

    offset: Offset
    time: float


class ClockOffset:
    """Keeps the offset of one partner's clock.

    Parameters
    ----------
    parameters : ExchangeParameters
    """

    def __init__(self, parameters: ExchangeParameters) -> None:
        self._drift = parameters.drift
        self._measured: deque[_Measured] = deque(maxlen=parameters.kept)

    def add(self, exchange: Exchange) -> bool:
        """Add an exchange; returns whether it contradicts those before, which are forgotten then: a clock has jumped.

        One that cannot be (an answer before its question) is left out.
        """
        if not are_finite(*exchange):
            return False
        asked, received, answered, returned = exchange
        uncertainty = ((returned - asked) - (answered - received)) / 2.0
        if answered < received or uncertainty < 0.0:
            return False
        return self.add_offset(Offset(((asked - received) + (returned - answered)) / 2.0, uncertainty), returned)

    def add_offset(self, offset: Offset, now: float) -> bool:
        """Add an offset that was measured otherwise; as `add`."""
        jumped = self.contradicts(offset, now)
        if jumped:
            self._measured.clear()
        self._measured.append(_Measured(offset, now))
        return jumped

    def contradicts(self, offset: Offset, now: float) -> bool:
        """Whether an offset that was measured now cannot be, by what is known."""
        known = self.at(now)
        return known is not None and (
            abs(offset.seconds - known.seconds) > offset.uncertainty + known.uncertainty + math.ulp(abs(now))
        )

    def at(self, now: float) -> Offset | None:
        """Return the offset as it is known now, s on the own clock; None if it is not known."""
        grown = (
            Offset(offset.seconds, offset.uncertainty + self._drift * abs(now - time))
            for offset, time in self._measured
        )
        return min(grown, key=lambda offset: offset.uncertainty, default=None)

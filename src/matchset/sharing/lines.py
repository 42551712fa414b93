"""What is said of partners, a line each, and never too much of it: `Lines`."""

from collections import Counter, deque
from collections.abc import Iterable

import msgspec

from matchset.numeric.arguments import require_positive


class LineParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How much is said.

    Parameters
    ----------
    period : float
        For which the numbers below hold, s. Chosen by hand.
    partner : int
        Lines of one partner. More tells more of one that comes and goes. Chosen by hand: it begins anew twice.
    together : int
        Lines in all. Chosen by hand: four partners have a bad network.
    """

    period: float = 60.0
    partner: int = 8
    together: int = 32

    def __post_init__(self) -> None:
        require_positive(self, self.__struct_fields__)


class Lines:
    """Keeps lines until they are taken; those of a period that are too many are counted, and told as one at its end.

    Parameters
    ----------
    parameters : LineParameters
    """

    def __init__(self, parameters: LineParameters) -> None:
        self._parameters = parameters
        self._lines: deque[str] = deque(maxlen=4 * parameters.together)
        self._begin, self._said, self._left_out = -parameters.period, Counter[str](), 0
        self._once = set[str]()

    def say(self, about: str, lines: Iterable[str], now: float) -> None:
        """Say lines about a partner, or count them."""
        self._look(now)
        for line in lines:
            if self._said[about] >= self._parameters.partner or self._said.total() >= self._parameters.together:
                self._left_out += 1
            else:
                self._said[about] += 1
                self._lines.append(line)

    def say_once(self, kind: str, line: str) -> None:
        """Say a line that counts as none of these, unless one of this kind was said before."""
        if kind not in self._once:
            self._once.add(kind)
            self._lines.append(line)

    def take(self, now: float) -> list[str]:
        """Return the lines since the last call."""
        self._look(now)
        lines = list(self._lines)
        self._lines.clear()
        return lines

    def _look(self, now: float) -> None:
        """Begin another period when one has ended."""
        if now - self._begin < self._parameters.period:
            return
        if self._left_out:
            self._lines.append(f"others: {self._left_out} more lines in {now - self._begin:.0f} s")
        self._begin, self._left_out = now, 0
        self._said.clear()

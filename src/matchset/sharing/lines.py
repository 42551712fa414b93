"""What is said of partners, a line each, and never too much of it: `Lines`."""

import math
from collections import Counter
from collections.abc import Iterable

import msgspec

from matchset.numeric.arguments import require_positive

LONGEST_LINE = 300  # format: characters; who prints it waits for no more


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
    """Keeps lines until they are taken; those that are too many are counted, and told as one line a period later.

    Parameters
    ----------
    parameters : LineParameters
    """

    def __init__(self, parameters: LineParameters) -> None:
        self._parameters = parameters
        self._lines, self._once = list[str](), set[str]()
        self._begin, self._said = -math.inf, Counter[str]()
        self._left_out, self._since = 0, 0.0

    def say(self, about: str, lines: Iterable[str], now: float) -> None:
        """Say lines about a partner, or count them."""
        limits = self._parameters
        if now - self._begin >= limits.period:
            self._begin = now
            self._said.clear()
        for line in lines:
            several = max(self._said.total(), len(self._lines))
            if self._said[about] < limits.partner and several < limits.together:
                self._said[about] += 1
                self._lines.append(line[:LONGEST_LINE])
            else:
                self._since = self._since if self._left_out else now
                self._left_out += 1

    def say_once(self, kind: str, line: str) -> None:
        """Say a line that counts as none of these, unless one of this kind was said before."""
        if kind not in self._once:
            self._once.add(kind)
            self._lines.append(line[:LONGEST_LINE])

    def take(self, now: float) -> list[str]:
        """Return the lines since the last call."""
        lines, self._lines = self._lines, []
        if self._left_out and now - self._since >= self._parameters.period:
            lines.append(f"others: {self._left_out} more lines in {now - self._since:.0f} s")
            self._left_out = 0
        return lines

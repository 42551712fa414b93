"""Numbers in words for people: rounded by what they are worth, with a standard deviation where there is one.

`one_line` is for every `__repr__` of the package: it never raises, whatever state the object is in.
"""

import functools
import html
import math
import numbers
from collections.abc import Callable, Iterable
from typing import Any

SHOWN = 4  # format: digits of a number without a standard deviation, and at least two decimals
MOST_DECIMALS = 9  # format: of any number


def one_line(describe: Callable[[Any], str]) -> Callable[[Any], str]:
    """Make a `__repr__` of a function that describes an object, which may be half built or damaged.

    Parameters
    ----------
    describe : callable
        Returns the words; what it raises is replaced by words that say so.
    """

    @functools.wraps(describe)
    def shown(this: Any) -> str:
        try:
            return " ".join(describe(this).split())
        except Exception as error:  # an error here would hide the one that is being reported
            return f"<{type(this).__name__}, incomplete: {type(error).__name__}>"

    return shown


def short(value: object) -> str:
    """Write a number with at least two decimals and four digits, anything else as it is."""
    if isinstance(value, bool) or not isinstance(value, numbers.Real):
        return repr(value)
    number = float(value)
    if not math.isfinite(number) or number == 0.0:
        return repr(number)
    return repr(round(number, min(max(2, SHOWN - 1 - math.floor(math.log10(abs(number)))), 300)))


def measured(value: float, sigma: float | None, sign: str = "") -> str:
    """Write a number with two digits of its standard deviation: ``397.31 ±0.10``.

    Parameters
    ----------
    value : float
    sigma : float or None
        Its standard deviation; where it is None, not finite or 0 the number stands alone.
    sign : str
        "+" shows the sign of positive numbers, too.
    """
    if sigma is None or not (math.isfinite(value) and 0.0 < sigma < math.inf):
        return short(value)
    decimals = min(max(1 - math.floor(math.log10(sigma)), 0), MOST_DECIMALS)
    return f"{value:{sign}z.{decimals}f} ±{sigma:.{decimals}f}"


def table_of(title: str, rows: Iterable[tuple[str, str]]) -> str:
    """HTML table of names and values, for notebooks; everything in it is escaped.

    Parameters
    ----------
    title : str
    rows : iterable of (str, str)
    """
    cells = "".join(
        f"<tr><td style='text-align:left'>{html.escape(name)}</td>"
        f"<td style='text-align:left'>{html.escape(value)}</td></tr>"
        for name, value in rows
    )
    return f"<table><caption style='text-align:left'><b>{html.escape(title)}</b></caption>{cells}</table>"

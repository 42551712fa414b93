"""Checks of what a caller hands in: an error that shows it and says what is wanted, instead of one from inside."""

import math
import numbers
import operator
from typing import Any


def check_kind(name: str, value: object, kinds: type[Any] | tuple[type[Any], ...], instead: str = "") -> None:
    """Refuse a value of another type (TypeError).

    Parameters
    ----------
    name : str
        What it is, for the message.
    value : object
    kinds : type or tuple of types
        What it may be.
    instead : str
        What the caller should do.
    """
    if not isinstance(value, kinds):
        each = kinds if isinstance(kinds, tuple) else (kinds,)
        wanted = " or ".join("None" if kind is type(None) else kind.__name__ for kind in each)
        shown = type(value).__name__
        if isinstance(value, str | int | float):
            shown += f" {value!r:.60}"
        raise TypeError(f"{name} must be a {wanted}, got {shown}{instead and f': {instead}'}")


def check_number(name: str, value: object) -> None:
    """Refuse what is no real number (TypeError), a word of digits among it."""
    if not isinstance(value, numbers.Real):
        raise TypeError(f"{name} must be a number, got {value!r:.60}")


def are_finite(*values: object) -> bool:
    """Whether all are finite numbers; a word or None is none."""
    try:
        return all(map(math.isfinite, values))  # type: ignore[arg-type]
    except TypeError:
        return False


def checked_count(name: str, value: object, least: int, most: int) -> int:
    """Whole number from `least` to `most`; a ValueError that shows another one, and a TypeError for no number."""
    try:
        count = operator.index(value)  # type: ignore[arg-type]
    except TypeError:
        error = ValueError if isinstance(value, float) else TypeError
        raise error(f"{name} must be a whole number, {least} to {most}, got {value!r:.60}") from None
    if isinstance(value, bool) or not least <= count <= most:
        raise ValueError(f"{name} must be a whole number, {least} to {most}, got {value!r}")
    return count


def checked_point(name: str, value: object) -> tuple[float, float]:
    """Point (x, y) of finite numbers; a ValueError that shows what is none."""
    words = f"{name} must be finite, a point (x, y) in px"
    try:
        x, y = (float(each) for each in value)  # type: ignore[attr-defined]
    except (TypeError, ValueError):
        raise ValueError(f"{words}, got {value!r:.60}") from None
    if isinstance(value, str) or not (math.isfinite(x) and math.isfinite(y)):
        raise ValueError(f"{words}, got {value!r:.60}")
    return x, y

"""Checks of what a caller hands in: an error that shows it and says what is wanted, instead of one from inside.

`require` and its like check fields of a parameters struct; the text begins with the field's name, its key in a file.
"""

import math
import numbers
import operator
from collections.abc import Callable, Iterable, Mapping
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


def require(parameters: object, names: Iterable[str], holds: Callable[[float], bool], rule: str) -> None:
    """Check fields of a parameters struct.

    Parameters
    ----------
    parameters : object
    names : iterable of str
        Which fields.
    holds : callable
        Whether a value is allowed.
    rule : str
        The same in words: "positive".

    Raises
    ------
    ValueError
        For the first field that is not allowed; the text begins with its name.
    """
    for name in names:
        value = getattr(parameters, name)
        if not holds(value):
            raise ValueError(f"{name} must be {rule}, got {value}")


def require_positive(parameters: object, names: Iterable[str]) -> None:
    """Check that fields are positive and finite; see `require`."""
    require(parameters, names, lambda value: 0.0 < value < math.inf, "positive")


def require_not_negative(parameters: object, names: Iterable[str]) -> None:
    """Check that fields are zero or positive, and finite; see `require`."""
    require(parameters, names, lambda value: 0.0 <= value < math.inf, "zero or positive")


def require_share(parameters: object, names: Iterable[str]) -> None:
    """Check that fields are within 0 ... 1; see `require`."""
    require(parameters, names, lambda value: 0.0 <= value <= 1.0, "within 0 ... 1")


def require_at_least(parameters: object, least: float, *names: str) -> None:
    """Check that fields are so much or more; see `require`."""
    require(parameters, names, lambda value: value >= least, f"{least:g} or more")


def require_within(parameters: object, limits: Mapping[str, tuple[float, float]], rule: str = "must be within") -> None:
    """Check that fields are within their limits, the limits among it; see `require`.

    Parameters
    ----------
    parameters : object
    limits : mapping of str to (float, float)
        The least and the most of each field.
    rule : str
        What stands between the name and the limits.
    """
    for name, (least, most) in limits.items():
        value = getattr(parameters, name)
        if not least <= value <= most:
            raise ValueError(f"{name} {rule} {least:g} ... {most:g}, got {value}")

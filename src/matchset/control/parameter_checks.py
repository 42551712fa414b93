"""Checks of parameters: a value out of range is refused with its name, which is its key in a file."""

import math
from collections.abc import Callable, Iterable

import msgspec


def require(parameters: msgspec.Struct, names: Iterable[str], holds: Callable[[float], bool], rule: str) -> None:
    """Check fields of a parameters struct.

    Parameters
    ----------
    parameters : Struct
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


def require_positive(parameters: msgspec.Struct, names: Iterable[str]) -> None:
    """Check that fields are positive and finite; see `require`."""
    require(parameters, names, lambda value: 0.0 < value < math.inf, "positive")


def require_not_negative(parameters: msgspec.Struct, names: Iterable[str]) -> None:
    """Check that fields are zero or positive, and finite; see `require`."""
    require(parameters, names, lambda value: 0.0 <= value < math.inf, "zero or positive")


def require_share(parameters: msgspec.Struct, names: Iterable[str]) -> None:
    """Check that fields are within 0 ... 1; see `require`."""
    require(parameters, names, lambda value: 0.0 <= value <= 1.0, "within 0 ... 1")

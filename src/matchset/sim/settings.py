"""Settings from TOML: whatever is wrong is refused with the key and the line."""

import re
import tomllib
from typing import Any, TypeVar

import msgspec

S = TypeVar("S")


def read_settings(text: str, kind: type[S], name: str) -> S:
    """Turn TOML into a struct.

    Parameters
    ----------
    text : str
        The TOML.
    kind : type
        A `msgspec.Struct`.
    name : str
        What the text is called in errors.

    Raises
    ------
    ValueError
        If it is no TOML, or a key is missing, unknown or of a wrong kind, or a value is refused; ``name, line 3: ...``.
    """
    try:
        table: dict[str, Any] = tomllib.loads(text)
    except (tomllib.TOMLDecodeError, RecursionError) as error:
        raise ValueError(f"{name}: {error}") from None
    try:
        return msgspec.convert(table, kind)
    except (msgspec.ValidationError, ValueError) as error:
        words = " ".join(str(error).split())
        raise ValueError(f"{name}{_place(text, words)}: {words}") from None


def _place(text: str, words: str) -> str:
    """Find the line of the key that an error is about."""
    keys = re.findall(r"`\$?\.?([\w.]+)`", words) + words.split()[:1]
    for key in (part for whole in keys for part in reversed(whole.split("."))):
        for number, line in enumerate(text.splitlines(), 1):
            if re.match(rf"\s*{re.escape(key)}\s*=", line):
                return f", line {number}"
    return ""

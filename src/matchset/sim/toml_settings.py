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
    """Find the line of the key that an error is about: the last of its path, in the table that the path names."""
    path = re.search(r"at `\$\.?([\w.]*)`", words)
    tables = [part for part in (path.group(1).split(".") if path else []) if part]
    named = [key.split(".")[-1] for key in re.findall(r"field `([\w.]+)`", words)]
    found = _keys(text)
    for key in [*named, *words.split()[:1]]:
        for line, table, name in found:
            if name == key and (table == tables or not path):
                return f", line {line}"
    for line, table, name in found:
        if [*table, name] == tables:
            return f", line {line}"
    return ""


def _keys(text: str) -> list[tuple[int, list[str], str]]:
    """Line, table and name of every key and every table header."""
    table: list[str] = []
    found = []
    for number, line in enumerate(text.splitlines(), 1):
        header = re.match(r"\s*\[\[?\s*([\w.\-]+)\s*\]", line)
        key = re.match(r"\s*([\w\-]+)\s*=", line)
        if header:
            table = header.group(1).split(".")
            found.append((number, table[:-1], table[-1]))
        elif key:
            found.append((number, table, key.group(1)))
    return found

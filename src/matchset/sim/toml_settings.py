"""Settings from TOML: whatever is wrong is refused with the key and the line."""

import re
import tomllib
from collections.abc import Callable
from typing import Any, TypeVar

import msgspec

from matchset.control.files.older_keys import kind_of, newer_key, with_newer_keys

S = TypeVar("S")


def read_settings(text: str, kind: type[S], name: str, note: Callable[[str], None] | None = None) -> S:
    """Turn TOML into a struct; keys may be those that files had before.

    Parameters
    ----------
    text : str
        The TOML.
    kind : type
        A `msgspec.Struct`.
    name : str
        What the text is called in errors.
    note : callable, optional
        Is told in words if there are older keys.

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
        table, older = with_newer_keys(table, kind)
        settings = msgspec.convert(table, kind)
    except (msgspec.ValidationError, ValueError) as error:
        words = " ".join(str(error).split())
        raise ValueError(f"{name}{_place(text, words, kind)}: {words}") from None
    if older and note is not None:
        before, now = older[-1]
        note(f"{name} has older names of {len(older)} settings, which are read: {before} is now {now}")
    return settings


def _place(text: str, words: str, kind: type) -> str:
    """Find the line of the key that an error is about: the last of its path, in the table that the path names."""
    path = re.search(r"at `\$\.?([\w.]*)`", words)
    tables = [part for part in (path.group(1).split(".") if path else []) if part]
    named = [key.split(".")[-1] for key in re.findall(r"field `([\w.]+)`", words)]
    found = [(line, *_newer(table, name, kind)) for line, table, name in _keys(text)]
    for key in [*named, *words.split()[:1]]:
        for line, table, name in found:
            if name == key and (table == tables or not path):
                return f", line {line}"
    for line, table, name in found:
        if [*table, name] == tables:
            return f", line {line}"
    return ""


def _newer(table: list[str], name: str, kind: type) -> tuple[list[str], str]:
    """Return a table and a key of it under the names of now."""
    path: list[str] = []
    around: type | None = kind
    for key in table:
        path.append(newer_key(key, around))
        around = kind_of(path[-1], around)
    return path, newer_key(name, around)


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

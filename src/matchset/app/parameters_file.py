"""Parameters of a tracker as a TOML file: `matchset params` prints them, `--params FILE` reads them.

The dials of `TrackerParameters` come first, then all other numbers, by groups: one versioned artifact, the fields of
`TrackerConstants`. A new one appears by itself. The comments are taken from the docstrings.
"""

import inspect
import json
import re
import textwrap
import tomllib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import msgspec

from matchset.image.files.limits import LIMITS
from matchset.image.files.reading import read_text
from matchset.tracking.constants import VERSION, TrackerConstants
from matchset.tracking.parameters import DIALS, TrackerParameters, value_at

_WIDTH = 100  # format: longest line of a comment
_MAX = 1e6  # format: largest number in a file; no length, time or count of a tracker is larger


def tracker_parameters(path: Path | None) -> TrackerParameters:
    """Read the parameters of a tracker.

    Parameters
    ----------
    path : Path or None
        A TOML file as `parameters_toml` writes it; what is missing in it has its default. None: all have.

    Returns
    -------
    TrackerParameters

    Raises
    ------
    ValueError
        If the file cannot be read, or a key is unknown, or a value has another type or is out of range; the message
        names file and key.
    """
    if path is None:
        return TrackerParameters()
    try:
        values = tomllib.loads(read_text(path, LIMITS.text))
    except FileNotFoundError:
        raise ValueError(f"no such file: {path}") from None
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror}") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"{path} is not TOML: {error}") from None
    groups = {name: value for name, value in values.items() if name not in DIALS}
    dials = {name: value for name, value in values.items() if name in DIALS}
    for problem in (*_dial_problems(dials), *_problems(groups, TrackerConstants(), "")):
        raise ValueError(f"{path}: {problem}")
    if groups.get("version", VERSION) != VERSION:
        raise ValueError(f"{path}: version must be {VERSION}, got {groups['version']}: it is of another matchset")
    try:
        constants = msgspec.convert(groups, TrackerConstants) if groups else None
        return TrackerParameters(**dials, constants=constants)
    except (msgspec.ValidationError, ValueError) as error:
        raise ValueError(f"{path}: {error}") from None


def _dial_problems(dials: Mapping[str, Any]) -> Iterator[str]:
    """Yield what is wrong with the values of dials."""
    for name, value in dials.items():
        problem = _problem_of(value, value_at(TrackerConstants(), DIALS[name]))
        if problem is not None:
            yield f"{name} must be {problem}, got {value!r}"


def _problems(values: Mapping[str, Any], defaults: msgspec.Struct, table: str) -> Iterator[str]:
    """Yield what is wrong with the keys and values of a table."""
    for name, value in values.items():
        key = f"{table}{name}"
        if name not in defaults.__struct_fields__:
            yield f"there is no parameter {key!r}; 'matchset params' prints all"
            continue
        default = getattr(defaults, name)
        if isinstance(default, msgspec.Struct):
            if isinstance(value, dict):
                yield from _problems(value, default, f"{key}.")
            else:
                yield f"{key} must be a table, got {value!r}"
        elif (problem := _problem_of(value, default)) is not None:
            yield f"{key} must be {problem}, got {value!r}"


def _problem_of(value: Any, default: Any) -> str | None:
    """Return what a value must be, if it is something else; no number is negative whose default is not."""
    if isinstance(default, bool):
        return None if isinstance(value, bool) else "true or false"
    if not isinstance(default, (int, float)):
        return None  # its type is checked by msgspec
    whole = isinstance(default, int)
    if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)):
        return "a whole number" if whole else "a number"
    if value != value or (abs(value) > _MAX and value != default):
        return f"a number up to {_MAX:g}"
    if whole and value < 1 <= default:
        return "1 or more"
    return "0 or more" if value < 0 <= default else None


def parameters_toml(parameters: TrackerParameters) -> str:
    """Write the parameters of a tracker as TOML, each with its meaning and its default as a comment.

    Parameters
    ----------
    parameters : TrackerParameters

    Returns
    -------
    str
        What `tracker_parameters` reads.
    """
    constants = parameters.constants or TrackerConstants()
    return "\n".join((*_dials(parameters), "", "", *_table(constants, ""))) + "\n"


def _dials(parameters: TrackerParameters) -> Iterator[str]:
    """Yield the lines of the dials: one that is not turned is a comment."""
    doc = inspect.getdoc(type(parameters)) or ""
    meanings = _meanings(doc)
    yield from _comment(doc.split("\n\n")[0])
    for dial, path in DIALS.items():
        value, default = getattr(parameters, dial), value_at(TrackerConstants(), path)
        yield ""
        yield from _comment(meanings[dial])
        yield f"# Default: {_value(default)}"
        yield f"# {dial} = {_value(default)}" if value is None else f"{dial} = {_value(value)}"


def _table(parameters: msgspec.Struct, name: str) -> Iterator[str]:
    """Yield the lines of a struct: its own numbers first, then its structs as tables."""
    doc = inspect.getdoc(type(parameters)) or ""
    meanings = _meanings(doc)
    defaults = type(parameters)()
    yield from _comment(doc.split("\n\n")[0])
    if name:
        yield f"[{name.rstrip('.')}]"
    groups = []
    explained: dict[str, str] = {}
    for field in parameters.__struct_fields__:
        value = getattr(parameters, field)
        if not name and field in DIALS:
            continue
        if isinstance(value, msgspec.Struct):
            groups.append((value, f"{name}{field}."))
            continue
        meaning = meanings.get(field, "")
        first = explained.setdefault(meaning, field)
        yield ""
        yield from _comment(meaning if first == field else f"See {first}.")
        yield f"# Default: {_value(getattr(defaults, field))}"
        yield f"{field} = {_value(value)}"
    for value, table in groups:
        yield ""
        yield ""
        yield from _table(value, table)


def _meanings(doc: str) -> dict[str, str]:
    """Return the description of each parameter in a numpydoc docstring."""
    _, _, section = doc.partition("Parameters\n----------\n")
    meanings: dict[str, str] = {}
    for entry in re.split(r"\n(?=\S)", section):
        head, _, text = entry.partition("\n")
        names, colon, _ = head.partition(" : ")
        if colon:
            meanings |= dict.fromkeys((each.strip() for each in names.split(",")), " ".join(text.split()))
    return meanings


def _comment(text: str) -> list[str]:
    return [f"# {line}" for line in textwrap.wrap(" ".join(text.split()), _WIDTH - 2)]


def _value(value: Any) -> str:
    """Return a value as TOML."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_value, value)) + "]"
    return json.dumps(value) if isinstance(value, str) else repr(value)

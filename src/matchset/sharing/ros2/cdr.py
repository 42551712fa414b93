"""Messages of ROS 2 as bytes: CDR (XCDR1, little endian) of values in the order of a definition, `CdrEncoder`.

Four bytes say that it is little-endian CDR. From there on every number stands at a multiple of its own size, a string
is its length, its bytes and a zero, which counts, and a sequence is its length and its elements; a message is its
members, one after the other. Source: OMG DDSI-RTPS 10 and DDS-XTypes 7.4 (XCDR version 1), as ROS 2 uses them.
"""

import re
import struct
from collections.abc import Callable, Mapping
from typing import Any

HEADER = b"\x00\x01\x00\x00"  # format: plain CDR, little endian, no options
SEPARATOR = "=" * 80  # format: between the definitions in the text of a schema
# format: struct's letter of each number of a definition
NUMBERS = {
    "bool": "?",
    "byte": "B",
    "uint8": "B",
    "int8": "b",
    "uint16": "H",
    "int16": "h",
    "uint32": "I",
    "int32": "i",
    "uint64": "Q",
    "int64": "q",
    "float32": "f",
    "float64": "d",
}
FIELD = re.compile(r"([A-Za-z][\w/]*)(?:(\[)(\d*)\])?\s+[a-z]\w*")

Definitions = Mapping[str, str]
Write = Callable[[bytearray, Any], None]


class CdrEncoder:
    """Encodes messages of one type.

    Parameters
    ----------
    kind : str
        The type: ``geometry_msgs/Pose``.
    definitions : mapping of str to str
        For each type, the lines of its definition: ``float64[36] covariance``, ``Pose[] poses``. Types are named in
        full. Constants, defaults and bounded lengths are not known.

    Raises
    ------
    ValueError
        If a definition is missing or cannot be read.
    """

    def __init__(self, kind: str, definitions: Definitions) -> None:
        self.kind = kind
        self._write = _member(kind, definitions)

    def encode(self, values: Any) -> bytes:
        """Encode a message.

        Parameters
        ----------
        values : tuple
            A value for each member: a number, str, a tuple for a message, a sequence for an array, bytes for uint8[].

        Raises
        ------
        ValueError
            If there are more or fewer values than members, or one does not fit its type.
        """
        out = bytearray(HEADER)
        try:
            self._write(out, values)
        except (struct.error, TypeError, AttributeError) as error:
            raise ValueError(f"no {self.kind}: {error}") from error
        return bytes(out)


def schema_text(kind: str, definitions: Definitions) -> str:
    """Text of a schema "ros2msg": the definition of a type, then those of all types in it.

    Parameters
    ----------
    kind : str
    definitions : mapping of str to str

    Returns
    -------
    str
        The definitions between lines of 80 equals signs, each but the first with its name: ``MSG: geometry_msgs/Pose``.
    """
    needed = [kind]
    for each in needed:
        needed += [part for part, _ in _fields(each, definitions) if part in definitions and part not in needed]
    return f"\n{SEPARATOR}\n".join(
        definitions[each].strip() if each == kind else f"MSG: {each}\n{definitions[each].strip()}" for each in needed
    )


def _fields(kind: str, definitions: Definitions) -> list[tuple[str, str | None]]:
    """Type of each member; and None for a single value, "" for a sequence, its length for an array."""
    if kind not in definitions:
        raise ValueError(f"no definition of {kind}")
    found: list[tuple[str, str | None]] = []
    for line in definitions[kind].strip().splitlines():
        field = FIELD.fullmatch(line.partition("#")[0].strip())
        if field is None:
            raise ValueError(f"{kind}: cannot read {line!r}")
        found.append((field[1], field[3] if field[2] else None))
    return found


def _member(kind: str, definitions: Definitions) -> Write:
    """Return what writes a single value of a type."""
    if kind in NUMBERS:
        return _numbers(NUMBERS[kind])
    if kind == "string":
        return _write_string
    writers = [
        _member(part, definitions) if length is None else _array(part, length, definitions)
        for part, length in _fields(kind, definitions)
    ]

    def write(out: bytearray, values: Any) -> None:
        if len(values) != len(writers):
            raise ValueError(f"{kind} has {len(writers)} members, got {len(values)}")
        for writer, value in zip(writers, values, strict=True):
            writer(out, value)

    return write


def _numbers(letter: str, count: int | None = None) -> Write:
    """Return what writes one number, or an array of so many."""
    packer = struct.Struct(f"<{1 if count is None else count}{letter}")
    size = struct.calcsize(letter)

    def write(out: bytearray, value: Any) -> None:
        out.extend(bytes((len(HEADER) - len(out)) % size))
        out.extend(packer.pack(value) if count is None else packer.pack(*value))

    return write


def _array(kind: str, length: str, definitions: Definitions) -> Write:
    """Return what writes an array; of any length if none is given."""
    count = int(length) if length else None
    if count is not None and kind in NUMBERS:
        return _numbers(NUMBERS[kind], count)
    write_length, write_one = _numbers("I"), _member(kind, definitions)

    def write(out: bytearray, values: Any) -> None:
        if count is None:
            write_length(out, len(values))
        elif len(values) != count:
            raise ValueError(f"{kind}[{count}] got {len(values)} values")
        if kind == "uint8":
            out.extend(bytes(values))
        elif kind in NUMBERS and len(values):
            _numbers(NUMBERS[kind], len(values))(out, values)
        else:
            for value in values:
                write_one(out, value)

    return write


def _write_string(out: bytearray, value: Any) -> None:
    coded = value.encode() + b"\0"
    _write_length(out, len(coded))
    out.extend(coded)


_write_length = _numbers("I")

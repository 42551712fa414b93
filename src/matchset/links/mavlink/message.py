"""What a MAVLink message consists of, from which it is packed, parsed and documented: `MavlinkMessage`, `MessageField`.

A payload holds the fields with the largest type first, otherwise in their order; extension fields follow in their
order (MAVLink's guide, "Packet Serialization"). Numbers are little-endian. MAVLink 2 leaves out zero bytes at the end
of a payload, but never the first byte.
"""

import struct
from collections.abc import Sequence
from functools import cached_property
from typing import Any

import msgspec

from matchset.links.mavlink.checksum import accumulate

SIZES = {  # format: bytes and letter in `struct` of each type
    "uint64_t": (8, "Q"),
    "int64_t": (8, "q"),
    "double": (8, "d"),
    "uint32_t": (4, "I"),
    "int32_t": (4, "i"),
    "float": (4, "f"),
    "uint16_t": (2, "H"),
    "int16_t": (2, "h"),
    "uint8_t": (1, "B"),
    "int8_t": (1, "b"),
    "char": (1, "s"),
}

Values = dict[str, Any]
"""Values of a message by the names of its fields: int, float, str, or a tuple of them for an array."""


class MessageField(msgspec.Struct, frozen=True):
    """A field of a message.

    Attributes
    ----------
    name : str
    kind : str
        Its type as in MAVLink's definitions: ``uint8_t``, ``float[4]``, ``char[50]``.
    unit : str
        As in MAVLink's definitions; empty for numbers and codes.
    what : str
        What it means, in words.
    extension : bool
        Whether it came to the message later: it is neither sorted nor part of CRC_EXTRA.
    """

    name: str
    kind: str
    unit: str = ""
    what: str = ""
    extension: bool = False

    @property
    def base(self) -> str:
        """Type of one element."""
        return self.kind.partition("[")[0]

    @property
    def count(self) -> int:
        """Number of elements of an array; 0 for a single value."""
        return int(self.kind.partition("[")[2].rstrip("]") or 0)

    @property
    def is_text(self) -> bool:
        """Whether it holds characters."""
        return self.base == "char"


class MavlinkMessage(msgspec.Struct, frozen=True, dict=True):
    """A message and all its fields, in the order of MAVLink's definitions.

    Attributes
    ----------
    id : int
    name : str
    what : str
        What matchset uses it for, in words.
    fields : tuple of MessageField
    """

    id: int
    name: str
    what: str
    fields: tuple[MessageField, ...]

    @cached_property
    def wire_fields(self) -> tuple[MessageField, ...]:
        """The fields in the order of their bytes."""
        first = [field for field in self.fields if not field.extension]
        first.sort(key=lambda field: -SIZES[field.base][0])
        return (*first, *(field for field in self.fields if field.extension))

    @cached_property
    def layout(self) -> struct.Struct:
        """The bytes of a payload that is not truncated."""
        return struct.Struct("<" + "".join(f"{each.count or 1}{SIZES[each.base][1]}" for each in self.wire_fields))

    @cached_property
    def crc_extra(self) -> int:
        """The byte by which sender and receiver check that they mean the same fields.

        CRC-16/MCRF4XX of the name and, in the order of the wire, of type and name of every field that is no extension,
        each with a space, and of the lengths of arrays; its two bytes are joined by exclusive or.
        """
        crc = accumulate(f"{self.name} ".encode())
        for field in self.wire_fields:
            if not field.extension:
                crc = accumulate(f"{field.base} {field.name} ".encode(), crc)
                crc = accumulate(bytes([field.count]), crc) if field.count else crc
        return (crc & 0xFF) ^ (crc >> 8)

    def pack(self, values: Values) -> bytes:
        """Return the payload, without the zeros at its end.

        Parameters
        ----------
        values : dict
            By the names of the fields; what is missing is zero.

        Raises
        ------
        ValueError
            If there is no such field, or a value does not fit into it.
        """
        unknown = values.keys() - {field.name for field in self.fields}
        if unknown:
            raise ValueError(f"{self.name} has no field {', '.join(sorted(unknown))}")
        flat: list[Any] = []
        for field in self.wire_fields:
            flat += self._elements(field, values.get(field.name))
        try:
            payload = self.layout.pack(*flat)
        except (struct.error, OverflowError):
            raise ValueError(self._misfit(values)) from None
        return payload.rstrip(b"\0") or b"\0"

    def unpack(self, payload: bytes) -> Values:
        """Return the values of a payload, by name; bytes that were left out are zero, bytes beyond are ignored."""
        size = self.layout.size
        flat = iter(self.layout.unpack(payload[:size].ljust(size, b"\0")))
        values: Values = {}
        for field in self.wire_fields:
            if field.is_text:
                values[field.name] = next(flat).partition(b"\0")[0].decode("utf-8", "replace")
            else:
                values[field.name] = tuple(next(flat) for _ in range(field.count)) if field.count else next(flat)
        return values

    def _elements(self, field: MessageField, value: Any) -> Sequence[Any]:
        """Return the elements that a value takes in the payload."""
        if field.is_text:
            text = (value or "").encode()
            if len(text) > field.count:
                raise ValueError(f"{self.name}.{field.name} has room for {field.count} bytes, got {len(text)}")
            return [text]
        if value is None:
            return [0] * (field.count or 1)
        elements = list(value) if field.count else [value]
        if field.count and len(elements) != field.count:
            raise ValueError(f"{self.name}.{field.name} has {field.count} elements, got {len(elements)}")
        return elements

    def _misfit(self, values: Values) -> str:
        """Say which value does not fit into its field."""
        for field in self.wire_fields:
            elements = self._elements(field, values.get(field.name))
            try:
                struct.pack(f"<{field.count or 1}{SIZES[field.base][1]}", *elements)
            except (struct.error, OverflowError):
                return f"{self.name}.{field.name} is of type {field.kind}, got {values[field.name]!r}"
        return f"{self.name} cannot be packed"

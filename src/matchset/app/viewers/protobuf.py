"""Messages of Protocol Buffers 3 as bytes, from definitions in text: `ProtobufEncoder`, and their `descriptor_set`.

A message is its members in the order of their numbers, each with number and kind before it; numbers of seven bits a
byte, the lowest first. Members that are zero or empty are left out. Source: the encoding of Protocol Buffers 3, and
`google/protobuf/descriptor.proto`, whose messages say what a message holds.
"""

import re
import struct
from collections.abc import Callable, Iterator, Mapping
from typing import Any, NamedTuple

Definitions = Mapping[str, str]
Write = Callable[[Any], bytes]

VARINT, FIXED64, LENGTH, FIXED32 = 0, 1, 2, 5  # format: kinds of members
# format: kind of a member, and its type in a descriptor
TYPES = {
    "double": (FIXED64, 1),
    "int64": (VARINT, 3),
    "int32": (VARINT, 5),
    "fixed32": (FIXED32, 7),
    "bool": (VARINT, 8),
    "string": (LENGTH, 9),
    "bytes": (LENGTH, 12),
}
PACKERS = {"double": struct.Struct("<d").pack, "fixed32": struct.Struct("<I").pack}
MESSAGE, ENUM = 11, 14  # format: types in a descriptor
ONE, MANY = 1, 3  # format: labels in a descriptor
MEMBER = re.compile(r"(repeated )?([\w.]+) (\w+) = (\d+)")
_UINT64 = 2**64  # format: negative numbers are told by their remainder

# format: of descriptor.proto, what is used here
DESCRIPTORS = {
    "Set": "repeated File file = 1",
    "File": (
        "string name = 1\nstring package = 2\nrepeated string dependency = 3\n"
        "repeated Message message_type = 4\nstring syntax = 12"
    ),
    "Message": "string name = 1\nrepeated Field field = 2\nrepeated Enum enum_type = 4",
    "Field": (
        "string name = 1\nint32 number = 3\nint32 label = 4\nint32 type = 5\n"
        "string type_name = 6\nstring json_name = 10"
    ),
    "Enum": "string name = 1\nrepeated Value value = 2",
    "Value": "string name = 1\nint32 number = 2",
}


class Member(NamedTuple):
    """A member of a message: whether it is there many times, its type, name and number."""

    many: bool
    kind: str
    name: str
    number: int


class ProtobufEncoder:
    """Encodes messages of one type.

    Parameters
    ----------
    kind : str
        The type: ``foxglove.Pose``.
    definitions : mapping of str to str
        For each type the lines of its definition, ``repeated foxglove.Point2 points = 3``; for each enumeration its
        names, ``enum UNKNOWN POINTS``, from 0. Types are named in full.

    Raises
    ------
    ValueError
        If a definition is missing or cannot be read.
    """

    def __init__(self, kind: str, definitions: Definitions) -> None:
        self.kind = kind
        self._write = _message(kind, definitions)

    def encode(self, values: Mapping[str, Any]) -> bytes:
        """Encode a message.

        Parameters
        ----------
        values : mapping of str to value
            Members by their names: a number, str, bytes, a mapping for a message, the number of a name of an
            enumeration, a sequence of these. What is left out has no value.

        Raises
        ------
        ValueError
            If there is no such member, or a value does not fit its type.
        """
        try:
            return self._write(values)
        except (struct.error, TypeError, AttributeError) as error:
            raise ValueError(f"no {self.kind}: {error}") from error


def descriptor_set(kind: str, definitions: Definitions) -> bytes:
    """Describe a type as the schema of an MCAP file does: a FileDescriptorSet, one file for each type in it.

    Parameters
    ----------
    kind : str
    definitions : mapping of str to str

    Returns
    -------
    bytes
        Each file comes after those that it needs.
    """
    files = [_file(each, definitions) for each in _needed(kind, definitions)]
    return ProtobufEncoder("Set", DESCRIPTORS).encode({"file": files})


def members(kind: str, definitions: Definitions) -> list[Member]:
    """Return the members of a message, in the order of their numbers.

    Raises
    ------
    ValueError
        If the definition is missing or cannot be read.
    """
    if kind not in definitions:
        raise ValueError(f"no definition of {kind}")
    found = []
    for line in definitions[kind].splitlines():
        member = MEMBER.fullmatch(line.strip())
        if member is None:
            raise ValueError(f"{kind}: cannot read {line!r}")
        found.append(Member(member[1] is not None, member[2], member[3], int(member[4])))
    return sorted(found, key=lambda each: each.number)


def _is_enum(kind: str, definitions: Definitions) -> bool:
    return definitions.get(kind, "").startswith("enum ")


def _needed(kind: str, definitions: Definitions) -> Iterator[str]:
    """Yield the messages in a message, then itself; each once."""
    found = dict[str, None]()
    for member in members(kind, definitions):
        if member.kind not in TYPES and not _is_enum(member.kind, definitions):
            found |= dict.fromkeys(_needed(member.kind, definitions))
    yield from found
    yield kind


def _file_name(kind: str) -> str:
    package, _, name = kind.rpartition(".")
    return f"{package.replace('.', '/')}/{name.lower() if package.startswith('google') else name}.proto"


def _file(kind: str, definitions: Definitions) -> dict[str, Any]:
    """Describe the file of one message."""
    package, _, name = kind.rpartition(".")
    own = members(kind, definitions)
    enums = [each.kind for each in own if _is_enum(each.kind, definitions)]
    messages = {each.kind for each in own if each.kind not in TYPES and each.kind not in enums}
    told = [
        {
            "name": each.rpartition(".")[2],
            "value": [{"name": word, "number": k} for k, word in enumerate(definitions[each].split()[1:])],
        }
        for each in enums
    ]
    message = {"name": name, "field": [_field(each, definitions) for each in own], "enum_type": told}
    return {
        "name": _file_name(kind),
        "package": package,
        "dependency": sorted(map(_file_name, messages)),
        "message_type": [message],
        "syntax": "proto3",
    }


def _field(member: Member, definitions: Definitions) -> dict[str, Any]:
    first, *rest = member.name.split("_")
    told = {"name": member.name, "number": member.number, "label": MANY if member.many else ONE}
    told["json_name"] = first + "".join(each.capitalize() for each in rest)
    if member.kind in TYPES:
        return told | {"type": TYPES[member.kind][1]}
    return told | {"type": ENUM if _is_enum(member.kind, definitions) else MESSAGE, "type_name": f".{member.kind}"}


def _message(kind: str, definitions: Definitions) -> Write:
    """Return what encodes a message without its length."""
    writers = {each.name: _member(each, definitions) for each in members(kind, definitions)}

    def write(values: Mapping[str, Any]) -> bytes:
        if unknown := values.keys() - writers.keys():
            raise ValueError(f"{kind} has no {', '.join(sorted(unknown))}")
        return b"".join(writer(values[name]) for name, writer in writers.items() if name in values)

    return write


def _member(member: Member, definitions: Definitions) -> Write:
    """Return what encodes a member with its number; nothing for what is zero or empty."""
    is_enum = _is_enum(member.kind, definitions)
    sort = VARINT if is_enum else TYPES.get(member.kind, (LENGTH, 0))[0]
    number = member.number << 3
    key, packed = varint(number | sort), varint(number | LENGTH)
    if sort != LENGTH:
        pack: Write = PACKERS.get(member.kind, varint)
        if member.many:
            return lambda values: _sized(packed, b"".join(map(pack, values))) if len(values) else b""
        return lambda value: key + pack(value) if value else b""
    texts: dict[str, Write] = {"string": str.encode, "bytes": bytes}
    write = texts.get(member.kind) or _message(member.kind, definitions)
    if member.many:
        return lambda values: b"".join(_sized(key, write(value)) for value in values)
    if member.kind in TYPES:
        return lambda value: _sized(key, write(value)) if value else b""
    return lambda value: _sized(key, write(value))


def _sized(key: bytes, content: bytes) -> bytes:
    return key + varint(len(content)) + content


def varint(value: int) -> bytes:
    """Return a whole number as seven bits a byte, the lowest first."""
    rest, out = int(value) % _UINT64, bytearray()
    while rest > 0x7F:
        out.append(rest & 0x7F | 0x80)
        rest >>= 7
    return bytes((*out, rest))

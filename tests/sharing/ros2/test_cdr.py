"""CDR as the package rosbags reads it: any definition with any values comes back."""

import math
import struct
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

import bags
from matchset.sharing.ros2.cdr import HEADER, NUMBERS, CdrEncoder, schema_text
from matchset.sharing.ros2.ros_definitions import DEFINITIONS

NAMES = [name for name in NUMBERS if name != "byte"]
TEXTS = st.text(st.characters(exclude_categories=["Cs"], exclude_characters="\0"), max_size=9)
PART = "test_msgs/Part"


def values(name: str) -> st.SearchStrategy[Any]:
    if name == "string":
        return TEXTS
    if name == "bool":
        return st.booleans()
    if name.startswith("float"):
        return st.floats(width=32 if name == "float32" else 64)
    bits = int(name.lstrip("uint"))
    return st.integers(0, 2**bits - 1) if name.startswith("u") else st.integers(-(2 ** (bits - 1)), 2 ** (bits - 1) - 1)


@st.composite
def members(draw: st.DrawFn, kinds: list[str], depth: int = 0) -> tuple[list[str], list[Any]]:
    """Lines of a definition, and a value for each."""
    lines, chosen = [], []
    for number in range(draw(st.integers(1, 6))):
        kind = draw(st.sampled_from(kinds))
        form = draw(st.sampled_from(["", "[]", "[3]"]))
        one = st.just(None) if kind == PART else values(kind)
        size = {"": 1, "[3]": 3, "[]": draw(st.integers(0, 4))}[form]
        drawn = draw(st.lists(one, min_size=size, max_size=size))
        lines.append(f"{kind}{form} m{number}")
        chosen.append(drawn if form else drawn[0])
    return lines, chosen


def filled(value: Any, part: tuple[Any, ...]) -> Any:
    """Put the values of the inner message where the outer one has a gap."""
    if isinstance(value, list):
        return [filled(each, part) for each in value]
    return part if value is None else value


def plain(value: Any) -> Any:
    """A message of rosbags, or what is in one, as tuples and numbers; NaN as its name."""
    if hasattr(value, "__dataclass_fields__"):
        return tuple(plain(getattr(value, name)) for name in value.__dataclass_fields__ if name != "__msgtype__")
    if isinstance(value, list | tuple | np.ndarray):
        return [plain(each) for each in value]
    value = value.item() if isinstance(value, np.generic) else value
    return "nan" if isinstance(value, float) and math.isnan(value) else value


def expected(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(expected(each) for each in value)
    if isinstance(value, list):
        return [expected(each) for each in value]
    return "nan" if isinstance(value, float) and math.isnan(value) else value


def read_back(kind: str, definitions: dict[str, str], data: bytes) -> Any:
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    name = kind.replace("/", "/msg/")
    types = get_typestore(Stores.EMPTY)
    types.register(get_types_from_msg(schema_text(kind, definitions), name))
    return types.deserialize_cdr(data, name)


@settings(max_examples=150, suppress_health_check=[HealthCheck.too_slow])
@given(inner=members([*NAMES, "string"]), outer=members([*NAMES, "string", PART]))
def test_any_message_comes_back(inner: tuple[list[str], list[Any]], outer: tuple[list[str], list[Any]]) -> None:
    bags.need_rosbags()
    definitions = {PART: "\n".join(inner[0]), "test_msgs/Whole": "\n".join(outer[0])}
    message = tuple(filled(each, tuple(inner[1])) for each in outer[1])
    data = CdrEncoder("test_msgs/Whole", definitions).encode(message)
    assert plain(read_back("test_msgs/Whole", definitions, data)) == expected(message)


@pytest.mark.parametrize("kind", [kind for kind in DEFINITIONS if not kind.startswith("vision_msgs/")])
def test_definitions_are_those_of_ros(kind: str) -> None:
    bags.need_rosbags()
    from rosbags.typesys import get_types_from_msg

    types, name = bags.store(ros1=False), kind.replace("/", "/msg/")
    found = get_types_from_msg(schema_text(kind, DEFINITIONS), name)
    for each, (_, fields) in found.items():
        assert fields == types.fielddefs[each][1], each


def test_alignment_counts_from_behind_the_header() -> None:
    definitions = {"a/B": "uint8 one\nfloat64 two\nstring three\nuint16[] four"}
    data = CdrEncoder("a/B", definitions).encode((7, 1.5, "hi", [1, 2]))
    assert data[:4] == HEADER
    assert data[4:] == struct.pack("<B7xdI3sxI2H", 7, 1.5, 3, b"hi\0", 2, 1, 2)


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ((1,), "a/B has 2 members, got 1"),
        ((300, 1.0), "no a/B: "),
        ((1, "x"), "no a/B: "),
        (5, "no a/B: "),
    ],
)
def test_values_that_do_not_fit_are_refused(values: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        CdrEncoder("a/B", {"a/B": "uint8 one\nfloat64 two"}).encode(values)


def test_arrays_have_their_length() -> None:
    coder = CdrEncoder("a/B", {"a/B": "string[2] names\nfloat64[2] numbers"})
    with pytest.raises(ValueError, match=r"string\[2\] got 1 values"):
        coder.encode((["x"], [1.0, 2.0]))
    with pytest.raises(ValueError, match="no a/B"):
        coder.encode((["x", "y"], [1.0]))


@pytest.mark.parametrize("line", ["string<=5 name", "uint8 A=1", "float64[<=3] x", "nothing"])
def test_a_definition_that_is_not_known_is_refused(line: str) -> None:
    with pytest.raises(ValueError, match="cannot read"):
        CdrEncoder("a/B", {"a/B": line})
    with pytest.raises(ValueError, match="no definition of c/D"):
        CdrEncoder("a/B", {"a/B": "c/D inner"})

"""Messages of Protocol Buffers against the bytes that its documentation prints."""

import pytest

from foxglove_messages import decoded_message
from matchset.app.viewers.foxglove_definitions import DEFINITIONS, foxglove_encoder
from matchset.app.viewers.protobuf import ProtobufEncoder, descriptor_set, members, varint

# of "Encoding" in the documentation of Protocol Buffers
PRINTED = {
    "Test1": "int32 a = 1",
    "Test2": "string b = 2",
    "Test3": "Test1 c = 3",
    "Test4": "string d = 4\nrepeated int32 e = 6",
    "Lots": "repeated Test1 each = 1\nbool yes = 2\nbytes raw = 3\nrepeated string word = 4",
}


@pytest.mark.parametrize(
    ("kind", "values", "coded"),
    [
        ("Test1", {"a": 150}, "08 96 01"),
        ("Test1", {"a": -2}, "08 fe ff ff ff ff ff ff ff ff 01"),
        ("Test1", {"a": 0}, ""),
        ("Test2", {"b": "testing"}, "12 07 74 65 73 74 69 6e 67"),
        ("Test3", {"c": {"a": 150}}, "1a 03 08 96 01"),
        ("Test3", {"c": {}}, "1a 00"),
        ("Test4", {"d": "hello", "e": [1, 2, 3]}, "22 05 68 65 6c 6c 6f 32 03 01 02 03"),
        ("Test4", {"e": [], "d": ""}, ""),
        ("Lots", {"word": ["", "a"], "yes": True, "each": [{}, {"a": 1}]}, "0a 00 0a 02 08 01 10 01 22 00 22 01 61"),
    ],
)
def test_messages_are_the_bytes_that_are_printed(kind: str, values: dict[str, object], coded: str) -> None:
    assert ProtobufEncoder(kind, PRINTED).encode(values) == bytes.fromhex(coded)


@pytest.mark.parametrize(("value", "coded"), [(1, "01"), (127, "7f"), (128, "80 01"), (2**63, "80" * 9 + "01")])
def test_whole_numbers_have_seven_bits_a_byte(value: int, coded: str) -> None:
    assert varint(value) == bytes.fromhex(coded)


@pytest.mark.parametrize(
    ("kind", "values", "words"),
    [
        ("foxglove.Point2", {"z": 1.0}, "foxglove.Point2 has no z"),
        ("foxglove.Point2", {"x": "left"}, "no foxglove.Point2"),
        ("foxglove.CompressedImage", {"format": 3}, "no foxglove.CompressedImage"),
        ("foxglove.CameraCalibration", {"width": -1}, "no foxglove.CameraCalibration"),
    ],
)
def test_what_does_not_fit_is_named(kind: str, values: dict[str, object], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        foxglove_encoder(kind).encode(values)


def test_definitions_that_are_missing_or_broken_are_named() -> None:
    with pytest.raises(ValueError, match="no definition of Nothing"):
        ProtobufEncoder("Some", {"Some": "Nothing one = 1"})
    with pytest.raises(ValueError, match="Some: cannot read 'one'"):
        ProtobufEncoder("Some", {"Some": "one"})


def test_each_type_is_described_after_what_it_needs() -> None:
    coded = descriptor_set("foxglove.PoseInFrame", DEFINITIONS)
    names = [b"Quaternion", b"Vector3", b"Pose", b"Timestamp", b"PoseInFrame"]
    places = [coded.index(b"\x0a" + bytes([len(name)]) + name) for name in names]
    assert max(places[:2]) < places[2] < places[4] > places[3]
    assert coded.count(b"foxglove/Pose.proto") == 2  # the file, and who needs it


@pytest.mark.parametrize("kind", [kind for kind in DEFINITIONS if not DEFINITIONS[kind].startswith("enum")])
def test_numbers_of_members_are_given_once(kind: str) -> None:
    numbers = [each.number for each in members(kind, DEFINITIONS)]
    assert numbers == sorted(set(numbers))
    assert decoded_message(foxglove_encoder(kind).encode({}), kind) is not None

"""What is sent is read back; whatever else comes is refused by one sentence, and nothing else is raised."""

from typing import Any

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import matchset as ms
from matchset.flight.recording.encoding import encode
from matchset.sharing.messages import (
    FORMAT,
    MOST_BYTES,
    ClockMessage,
    ForeignMessageError,
    TargetsMessage,
    read_clock,
    read_targets,
    schema,
    written,
)
from matchset.sharing.shared_target import AgeParameters, shared_target
from sharing_poses import FULL, LEVEL, TRACK, target_messages


def message(**changed: Any) -> TargetsMessage:
    plain = TargetsMessage(
        format=FORMAT,
        name="left",
        run=7,
        number=3,
        sent=1.02,
        offsets=[],
        targets=target_messages({"ball": (TRACK, FULL)}, 1.0),
    )
    return msgspec.structs.replace(plain, **changed)


def test_what_is_written_is_read() -> None:
    assert read_targets(written(message())) == message()
    clock = ClockMessage(format=FORMAT, name="left", run=7, received=1.0, answered=1.5, wall=2e9)
    assert read_clock(written(clock)) == clock


@pytest.mark.parametrize("pose", [LEVEL, FULL], ids=["level", "full"])
def test_a_pose_is_written_as_in_a_recording(pose: ms.Pose) -> None:
    (target,) = target_messages(pose, pose.time)
    assert msgspec.msgpack.encode(target.pose) == encode(pose)


@pytest.mark.parametrize("pose", [LEVEL, FULL], ids=["level", "full"])
def test_a_pose_comes_back_to_the_last_bit(pose: ms.Pose) -> None:
    (target,) = read_targets(written(message(targets=target_messages(pose, 1.0)))).targets
    from matchset.sharing.clock_offset import Offset

    back = shared_target("left", target, Offset(0.0, 0.0), 1.01, AgeParameters()).pose
    assert isinstance(back, ms.Pose)
    assert encode(msgspec.structs.replace(back, time=pose.time)) == encode(pose)


@given(st.binary(max_size=400))
def test_any_bytes_are_read_or_refused(data: bytes) -> None:
    refused_or_read(data)


@given(st.integers(0, 10_000), st.integers(0, 255), st.integers(0, 10_000))
def test_a_damaged_message_is_read_or_refused(place: int, byte: int, length: int) -> None:
    data = bytearray(written(message()))
    data[place % len(data)] = byte
    refused_or_read(bytes(data))
    refused_or_read(bytes(data[: length % len(data)]))


JSON = st.recursive(
    st.none() | st.booleans() | st.integers(-(2**63), 2**64 - 1) | st.floats() | st.text(max_size=5),
    lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.sampled_from(FULL.__struct_fields__), inner),
    max_leaves=8,
)


@given(st.sampled_from(TargetsMessage.__struct_fields__), JSON)
def test_a_message_with_a_foreign_field_is_read_or_refused(field: str, value: Any) -> None:
    content = msgspec.msgpack.decode(written(message())) | {field: value}
    refused_or_read(msgspec.msgpack.encode(content))


@given(st.sampled_from(("position", "covariance", "rotation_matrix", "time", "observed")), JSON)
def test_a_pose_with_a_foreign_field_is_read_or_refused(field: str, value: Any) -> None:
    content = msgspec.msgpack.decode(written(message()))
    content["targets"][0]["pose"][field] = value
    refused_or_read(msgspec.msgpack.encode(content))


def refused_or_read(data: bytes) -> None:
    for read in (read_targets, read_clock):
        try:
            found: Any = read(data)
        except ForeignMessageError as error:
            words = str(error)
        else:
            words = ""
            assert read(written(found)) == found
            assert all(np.isfinite(value) for value in numbers(msgspec.to_builtins(found)))
        assert "\n" not in words
        assert len(words) < 200


def numbers(value: Any) -> list[float]:
    if isinstance(value, dict | list | tuple):
        return [each for part in (value.values() if isinstance(value, dict) else value) for each in numbers(part)]
    return [value] if isinstance(value, float) else []


@pytest.mark.parametrize(
    ("data", "words"),
    [
        (written(message(format=2)), "version 2, this is 1: this computer's matchset is older"),
        (written(message(format=0)), "version 0, this is 1: its matchset is older"),
        (msgspec.msgpack.encode({"format": 9, "all": "new"}), "version 9, this is 1: this computer's"),
        (b'{"x": 1}', "no message of matchset"),
        (msgspec.msgpack.encode([1, 2]), "no message of matchset"),
        (b"", "no message of matchset"),
        (b"\x00" * (MOST_BYTES + 1), f"more than {MOST_BYTES} bytes at once"),
        (written(message(sent=float("nan"))), "a damaged message: "),
        (written(message(name="")), "a damaged message: "),
    ],
)
def test_what_is_refused_says_what_it_is(data: bytes, words: str) -> None:
    with pytest.raises(ForeignMessageError, match=words):
        read_targets(data)


def test_what_is_refused_is_not_quoted_in_full() -> None:
    sent = msgspec.msgpack.decode(written(message(targets=target_messages(LEVEL, 1.0))))
    sent["targets"][0]["pose"]["observed"] = 50_000 * "x"
    with pytest.raises(ForeignMessageError, match=r"a damaged message: .* 'xxx") as raised:
        read_targets(msgspec.msgpack.encode(sent))
    assert len(str(raised.value)) < 300


def test_the_schema_is_for_other_programs() -> None:
    definitions = schema()["$defs"]
    assert {"TargetsMessage", "TargetMessage", "PoseMessage", "TrackMessage"} <= set(definitions)
    assert set(definitions["PoseMessage"]["properties"]) == set(ms.Pose.__struct_fields__)


def test_targets_of_several_trackers_have_names_of_their_own() -> None:
    several: list[ms.Target[ms.Circle]] = [
        ms.Target(0, "blue", TRACK, 0.0),
        ms.Target(1, "blue", ms.Lost("hidden", 1.0), 0.0),
    ]
    made = target_messages(several, 1.0)
    assert [(each.name, each.identity, each.lost) for each in made] == [("blue 0", 0, ""), ("blue 1", 1, "hidden")]
    (neighbor,) = target_messages([ms.Neighbor(4, LEVEL, ms.Lost("hidden", 1.0), (), False)], 1.0)
    assert (neighbor.name, neighbor.track, neighbor.lost) == ("neighbor 4", None, "")


@pytest.mark.parametrize(
    ("found", "error"),
    [
        ({"": TRACK}, ValueError),
        ({"x" * 65: TRACK}, ValueError),
        ({"ball": 3}, TypeError),
        ([3], TypeError),
        ({str(number): TRACK for number in range(65)}, ValueError),
    ],
)
def test_what_cannot_be_shared_is_refused(found: Any, error: type[Exception]) -> None:
    with pytest.raises(error):
        target_messages(found, 1.0)

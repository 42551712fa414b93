"""Keys, tokens and attachments as rmw_zenoh documents them, types as rosbags hashes and reads them."""

import importlib
import re
import secrets
import time
from collections.abc import Iterator
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

import bags
import matchset as ms
from matchset.sharing.clock import Clock
from matchset.sharing.connection import Connection, zenoh_settings
from matchset.sharing.messages import MOST_TARGETS
from matchset.sharing.ros2.ros_definitions import DEFINITIONS
from matchset.sharing.ros2.ros_keys import HASHES, RosNode, attachment, dds_type, identity_of, ros_name
from matchset.sharing.ros2.ros_sender import RosSender
from matchset.sharing.ros2.ros_values import DETECTIONS, POSE
from matchset.sharing.sent_targets import Shareable, sent_targets
from sharing_poses import FULL, LEVEL, TRACK
from sharing_processes import until

DOMAIN = 77
TOPIC = re.compile(r"\d+(/[a-zA-Z_]\w*)+/[a-z_]+::msg::dds_::\w+_/RIHS01_[0-9a-f]{64}")
NODE = r"@ros2_lv/\d+/[0-9a-f]+/(\d+)/{entity}/%/%/[a-zA-Z_]\w*"
PUBLISHER = NODE.format(entity=r"\d+/MP") + r"(/(?:%[a-zA-Z_]\w*)+/[\w:]+/RIHS01_[0-9a-f]{64}/)([\d,:]*)"
"""As docs/design.md of ros2/rmw_zenoh writes them."""


@pytest.fixture
def typestore() -> Any:
    bags.need_rosbags()
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.EMPTY)
    for kind, definition in DEFINITIONS.items():
        store.register(get_types_from_msg(definition, kind.replace("/", "/msg/")))
    return store


@pytest.mark.parametrize("kind", HASHES)
def test_the_hash_of_a_type_is_that_of_its_definition(kind: str, typestore: Any) -> None:
    assert typestore.hash_rihs01(kind.replace("/", "/msg/")) == HASHES[kind]


def test_rosbags_hashes_as_ros_does() -> None:
    """The one that the design of rmw_zenoh prints."""
    bags.need_rosbags()
    found = bags.store(ros1=False).hash_rihs01("std_msgs/msg/String")
    assert found == "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"


def test_keys_and_tokens_are_those_of_the_design() -> None:
    node = RosNode("8b20917502ee955ac4476e0266340d5c", "talker", 2)
    assert node.token == "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/0/NN/%/%/talker"
    key = node.topic_key("/robot1/chatter", POSE)
    assert key == f"2/robot1/chatter/geometry_msgs::msg::dds_::PoseWithCovarianceStamped_/{HASHES[POSE]}"
    token = node.publisher_token(10, "/robot1/chatter", DETECTIONS)
    assert token == (
        "@ros2_lv/2/8b20917502ee955ac4476e0266340d5c/0/10/MP/%/%/talker/%robot1%chatter/"
        f"vision_msgs::msg::dds_::Detection2DArray_/{HASHES[DETECTIONS]}/::,10:,:,:,,"
    )
    assert dds_type("std_msgs/String") == "std_msgs::msg::dds_::String_"
    assert TOPIC.fullmatch(key)
    assert re.fullmatch(PUBLISHER, token)


@pytest.mark.parametrize("domain", [-1, 233])
def test_a_domain_that_is_none_is_refused(domain: int) -> None:
    with pytest.raises(ValueError, match="the domain of ROS must be a whole number, 0 to 232"):
        RosNode("1", "talker", domain)


@given(st.text(max_size=20))
def test_any_words_become_a_name_that_ros_allows(words: str) -> None:
    assert re.fullmatch(r"[A-Za-z_][A-Za-z0-9_]*", ros_name(words))
    assert "__" not in ros_name(words)


NAMES = st.text(max_size=12) | st.text(alphabet="aB1 _-/äжF", max_size=12)


@given(st.sets(NAMES, max_size=64), st.sampled_from([" ", "_"]))
def test_different_words_never_become_the_same_name(words: set[str], joint: str) -> None:
    names = {each: ros_name(each, joint) for each in words}
    assert len(set(names.values())) == len(words)
    assert all(re.fullmatch(r"[A-Za-z][A-Za-z0-9]*(_[A-Za-z0-9]+)*", name) for name in names.values())


@pytest.mark.parametrize(
    ("words", "joint", "name"),
    [
        ("ball", " ", "ball"),
        ("ball 1", " ", "ball_1"),
        ("ball_1", " ", "ball_1_7d877783"),
        ("ball_1", "_", "ball_1"),
        ("ball 7d877783", " ", "ball_7d877783_36bca702"),
        ("2", " ", "target_2_f6c78813"),
        ("Bälle", " ", "Balle_36952468"),
        ("мяч", " ", "target_138d9124"),
        ("球", " ", "target_28b5a676"),
        ("", " ", "target_1271cf25"),
    ],
)
def test_names_are_those_that_the_rule_gives(words: str, joint: str, name: str) -> None:
    assert ros_name(words, joint) == name


@given(st.integers(0, 2**62), st.integers(0, 2**62))
def test_zenoh_itself_reads_what_is_attached(number: int, stamp: int) -> None:
    zenoh: Any = pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")
    identity = identity_of("a token")
    attached = attachment(number, stamp, identity)
    assert len(attached) == 33
    assert attached_values(zenoh.ZBytes(attached)) == (number, stamp, identity)


def attached_values(data: Any) -> tuple[int, int, bytes]:
    """What is attached to a message, as Zenoh reads it."""
    ext: Any = importlib.import_module("zenoh.ext")
    number, stamp, identity = ext.z_deserialize(tuple[ext.Int64, ext.Int64, bytes], data)
    return int(number), int(stamp), identity


@pytest.fixture
def listener() -> Iterator[Connection]:
    pytest.importorskip("zenoh", reason="eclipse-zenoh, the extra `net`, is not installed")
    with Connection(zenoh_settings("loopback", (), ())) as made:
        yield made


def test_who_listens_as_ros_does_gets_messages_that_rosbags_reads(listener: Connection, typestore: Any) -> None:
    name = f"left{secrets.token_hex(4)}"
    heard, tokens = dict[str, bytes | None](), set[str]()
    listener.listen(f"{DOMAIN}/{name}/**", heard.__setitem__)
    listener.watch(f"@ros2_lv/{DOMAIN}/**", lambda key, _: tokens.add(key))
    pose_key = f"{DOMAIN}/{name}/blue_ball/pose/{dds_type(POSE)}/{HASHES[POSE]}"
    detections_key = f"{DOMAIN}/{name}/detections/{dds_type(DETECTIONS)}/{HASHES[DETECTIONS]}"
    with ms.Share(name, key=f"test/{name}", ros_domain=DOMAIN) as share:
        lost: ms.Lost[ms.Circle] = ms.Lost("hidden", 0.0)
        found: dict[str, Shareable] = {"blue ball": (TRACK, FULL), "2": LEVEL, "gone": lost}

        def published() -> bool:
            share.publish(found, 10.0, 10.5)
            return {pose_key, detections_key} <= set(heard)

        until(published)
        assert all(TOPIC.fullmatch(key) for key in heard)
        until(lambda: sum(f"/matchset_{name}" in token for token in tokens.copy()) >= 4)  # a node, three publishers
        mine = {token for token in tokens.copy() if token.split("/")[8] == f"matchset_{name}"}
        assert {token.split("/")[9] for token in mine if "/MP/" in token} == {
            f"%{name}%detections",
            f"%{name}%blue_ball%pose",
            f"%{name}%{ros_name('2')}%pose",
        }
        assert sum("/NN/" in token for token in mine) == 1
        assert all(re.fullmatch(PUBLISHER, token) for token in mine if "/MP/" in token)
    pose = typestore.deserialize_cdr(heard[pose_key], "geometry_msgs/msg/PoseWithCovarianceStamped")
    assert pose.header.frame_id == f"{name}/camera"
    position = pose.pose.pose.position
    assert [position.x, position.y, position.z] == FULL.position.tolist()
    assert pose.pose.covariance.tolist() == FULL.covariance.ravel().tolist()
    read = typestore.deserialize_cdr(heard[detections_key], "vision_msgs/msg/Detection2DArray")
    assert read.header == pose.header
    (ball,) = read.detections
    assert (ball.id, ball.results[0].hypothesis.class_id, ball.results[0].hypothesis.score) == ("blue ball",) * 2 + (
        0.9,
    )
    assert ball.bbox.center.position.x == pytest.approx(70.5, abs=0.05)
    assert ball.bbox.size_x == pytest.approx(50.0, abs=0.1)
    stamp = pose.header.stamp.sec + 1e-9 * pose.header.stamp.nanosec
    assert -1.0 < time.time() - stamp - 0.5 < 60.0


def test_sequence_time_and_identity_are_attached(listener: Connection) -> None:
    name, samples = f"left{secrets.token_hex(4)}", list[Any]()
    subscriber = listener._session.declare_subscriber(f"{DOMAIN}/{name}/detections/**", samples.append)
    with ms.Share(name, key=f"test/{name}", ros_domain=DOMAIN) as share:

        def published() -> bool:
            share.publish(LEVEL, 10.0, 10.0)
            return len(samples) > 5

        until(published)
    subscriber.undeclare()
    read = [attached_values(each.attachment) for each in samples]
    assert [number - read[0][0] for number, _, _ in read] == list(range(len(read)))
    assert sorted(stamp for _, stamp, _ in read) == [stamp for _, stamp, _ in read]
    assert len({identity for _, _, identity in read}) == 1


def test_topics_of_targets_that_are_gone_are_withdrawn(listener: Connection) -> None:
    name, there = f"left{secrets.token_hex(4)}", set[str]()

    def seen(key: str, appeared: bool) -> None:
        (there.add if appeared else there.discard)(key)

    listener.watch(f"@ros2_lv/{DOMAIN}/**", seen)

    def topics() -> set[str]:
        tokens = [token.split("/") for token in there.copy()]
        return {parts[9] for parts in tokens if parts[5] == "MP" and parts[8] == f"matchset_{name}"}

    detections = f"%{name}%detections"
    with Connection(zenoh_settings("loopback", (), ())) as connection:
        sender = RosSender(connection, name, DOMAIN)
        for number in range(300):  # a page that names many targets
            sender.send(sent_targets({f"ball {number}": FULL, "kept": LEVEL}), [0.0, 0.0], 0.1 * number)
        assert len(sender._topics) <= MOST_TARGETS
        last = {f"%{name}%ball_299%pose", f"%{name}%kept%pose", detections}
        until(lambda: last <= topics() and len(topics()) <= 1 + MOST_TARGETS)
        lost: ms.Lost[ms.Circle] = ms.Lost("hidden", 0.0)
        sender.send(sent_targets({"kept": lost}), [0.0], 45.0)
        until(lambda: topics() == {f"%{name}%kept%pose", detections})
        sender.send(sent_targets({"kept": LEVEL, "back": LEVEL}), [0.0, 0.0], 46.0)
        until(lambda: len(topics()) == 3)
        numbers = [token.split("/")[4] for token in there if token.split("/")[8] == f"matchset_{name}"]
        assert len(set(numbers)) == len(numbers)
        sender.forget(60.0)
        until(lambda: topics() == {detections})
        assert len(connection._declared) == 3  # the node, and publisher and token of the detections


def test_a_share_that_publishes_nothing_more_withdraws_its_topics(listener: Connection) -> None:
    name, there, passed = f"left{secrets.token_hex(4)}", dict[str, bool](), [0.0]
    listener.watch(f"@ros2_lv/{DOMAIN}/**", there.__setitem__)
    right = Clock()
    clock = Clock(lambda: right.now() + passed[0], lambda: right.awake() + passed[0])
    with ms.Share(name, key=f"test/{name}", ros_domain=DOMAIN, clock=clock) as share:
        share.publish(LEVEL, 10.0, 10.0)
        token = share._ros._topics["ball"]._keys[1] if share._ros is not None else ""
        until(lambda: there.get(token))
        passed[0] = 11.0
        until(lambda: not there[token])

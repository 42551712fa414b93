"""How ROS 2 names things on Zenoh, as its middleware rmw_zenoh does: keys, tokens and attachments, `RosNode`.

A message goes to ``<domain>/<topic>/<type>/<hash>``, a token tells that a publisher is there (`ros2 topic list` reads
these), and sequence number, time and identity of the publisher are attached to each message. Source: docs/design.md of
ros2/rmw_zenoh, and the attachment as it writes it since its version 0.2.4 (Jazzy, Kilted, Rolling).
"""

import hashlib
import re
import struct
import unicodedata

import msgspec

from matchset.numeric.arguments import checked_count
from matchset.sharing.ros2.ros_values import DETECTIONS, POSE

# format: hashes of the types, RIHS01 of REP 2016: SHA-256 of the canonical JSON of a definition; tests/sharing/ros2
# compares them with what the package rosbags computes from these definitions
HASHES = {
    POSE: "RIHS01_26432f9803e43727d3c8f668d1fdb3c630f548af631e2f4e31382371bfea3b6e",
    DETECTIONS: "RIHS01_214274120007f4a683866481336b70310268cfa107aebe9d594a6acf75bda968",
}
SPACE = "@ros2_lv"
QOS = "::,10:,:,:,,"  # format: reliable, volatile, keep the last 10; an empty place is the default of rmw_zenoh
IDENTITY_BYTES = 16  # format: of a publisher
ATTACHMENT = struct.Struct(f"<qqB{IDENTITY_BYTES}s")  # format: of zenoh-ext: two int64, a length, bytes
LAST_DOMAIN = 232  # format: largest ROS_DOMAIN_ID
NODE_NUMBER = 0  # format: of the only node of a session
HASHED = r"[\W_][0-9a-f]{8}$"  # format: the end of names that are not only the words


class RosNode(msgspec.Struct, frozen=True):
    """A node of ROS 2 as others see it.

    Parameters
    ----------
    session : str
        What Zenoh calls the session, hexadecimal.
    name : str
    domain : int
        ROS_DOMAIN_ID: only those with the same one see each other.
    """

    session: str
    name: str
    domain: int = 0

    def __post_init__(self) -> None:
        checked_count("the domain of ROS", self.domain, 0, LAST_DOMAIN)

    @property
    def token(self) -> str:
        """Key that tells that the node is there."""
        return f"{SPACE}/{self.domain}/{self.session}/{NODE_NUMBER}/{NODE_NUMBER}/NN/%/%/{self.name}"

    def publisher_token(self, number: int, topic: str, kind: str) -> str:
        """Key that tells that a publisher of the node is there: its number from 1, ``/left/ball/pose``, its type."""
        begin = f"{SPACE}/{self.domain}/{self.session}/{NODE_NUMBER}/{number}/MP/%/%/{self.name}"
        return f"{begin}/{topic.replace('/', '%')}/{dds_type(kind)}/{HASHES[kind]}/{QOS}"

    def topic_key(self, topic: str, kind: str) -> str:
        """Key to which the messages of a topic go."""
        return f"{self.domain}/{topic.strip('/')}/{dds_type(kind)}/{HASHES[kind]}"


def dds_type(kind: str) -> str:
    """Return the name of a type as DDS has it: ``geometry_msgs::msg::dds_::Pose_`` of ``geometry_msgs/Pose``."""
    package, _, name = kind.partition("/")
    return f"{package}::msg::dds_::{name}_"


def identity_of(token: str) -> bytes:
    """Return 16 bytes that are those of this publisher alone.

    rmw_zenoh hashes the token with XXH3; receivers only compare these bytes with each other.
    """
    return hashlib.blake2b(token.encode(), digest_size=IDENTITY_BYTES).digest()


def attachment(number: int, stamp: int, identity: bytes) -> bytes:
    """Return what is attached to a message: its number, when it was sent, ns since 1970, and whose it is."""
    return ATTACHMENT.pack(number, stamp, len(identity), identity)


def ros_name(words: str, joint: str = " ") -> str:
    """Return a name that ROS 2 allows: letters, digits and single underscores, no digit first; another one for others.

    Words of Latin letters and digits with single joints between them keep these, as underscores: ``ball_1`` of
    ``ball 1``. All else would be what other words are, too: it is what can be written of it (accents are left out) and
    eight hexadecimal digits of its BLAKE2b: ``ball_1_7d877783`` of ``ball_1``. Two of 64 have the same in one of two
    million groups.
    """
    if re.fullmatch(rf"[A-Za-z][A-Za-z0-9]*({joint}[A-Za-z0-9]+)*", words) and not re.search(HASHED, words):
        return words.replace(joint, "_")
    plain = re.sub(r"[\W_]+", "_", unicodedata.normalize("NFKD", words).encode("ascii", "ignore").decode()).strip("_")
    if not plain[:1].isalpha():
        plain = f"target_{plain}".rstrip("_")
    return f"{plain}_{hashlib.blake2b(words.encode('utf-8', 'surrogatepass'), digest_size=4).hexdigest()}"

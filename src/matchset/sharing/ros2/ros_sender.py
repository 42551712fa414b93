"""Sends targets as nodes of ROS 2 do: `RosSender`. `ros2 topic echo` shows them where rmw_zenoh is used."""

import threading
import time
from collections.abc import Sequence
from typing import Any

from matchset.media.bags.packed_fields import NANO
from matchset.sharing.connection import Connection
from matchset.sharing.ros2.ros_definitions import encoder
from matchset.sharing.ros2.ros_keys import RosNode, attachment, identity_of, ros_name
from matchset.sharing.ros2.ros_values import DETECTIONS, NOWHERE, POSE, header_of, pose_with_covariance
from matchset.sharing.sent_targets import SentOutline, SentTarget

CDR = "application/cdr"
ROUTER = "tcp/localhost:7447"
"""Where the router of rmw_zenoh listens, without which nodes of ROS find nobody."""


class _Topic:
    """A publisher of a topic."""

    def __init__(self, connection: Connection, node: RosNode, number: int, topic: str, kind: str) -> None:
        self._encoder, self._number = encoder(kind), 0
        token = node.publisher_token(number, topic, kind)
        self._identity = identity_of(token)
        self._send = connection.publisher(node.topic_key(topic, kind), CDR)
        connection.appear(token)

    def send(self, values: tuple[Any, ...], now: float) -> None:
        """Send a message, at a time of day in s."""
        self._number += 1
        attached = attachment(self._number, round(NANO * now), self._identity)
        self._send(self._encoder.encode(values), attached)


class RosSender:
    """Sends targets as messages of ROS 2.

    `/left/ball/pose` is a geometry_msgs/PoseWithCovarianceStamped of each target with a pose, `/left/detections` a
    vision_msgs/Detection2DArray of all targets in the picture. Frames are called ``left/camera``: x right, y down, z
    forward, as REP 103 has it of cameras. Stamps are the times of capture on the clock of the day.

    Parameters
    ----------
    connection : Connection
    name : str
        Of the node and of the namespace of its topics.
    domain : int
        ROS_DOMAIN_ID.

    Raises
    ------
    ValueError
        If there is no such domain.
    """

    def __init__(self, connection: Connection, name: str, domain: int) -> None:
        self._connection, self._space = connection, ros_name(name)
        self._node = RosNode(connection.identity, f"matchset_{self._space}", domain)
        self._lock, self._topics = threading.Lock(), dict[str, _Topic]()
        connection.appear(self._node.token)
        self._topic("detections", DETECTIONS)

    def send(self, found: Sequence[SentTarget], ages: Sequence[float]) -> None:
        """Send what was found in a picture, or in several, of these ages, s.

        Raises
        ------
        LinkError
            If the session has ended.
        """
        now = time.time()
        headers = [header_of(now - age, f"{self._space}/camera") for age in ages]
        for header, each in zip(headers, found, strict=True):
            if each.pose is not None:
                topic = self._topic(f"{ros_name(each.name)}/pose", POSE)
                topic.send((header, pose_with_covariance(each.pose)), now)
        drawn = [(header, each, each.outline) for header, each in zip(headers, found, strict=True)]
        detections = [_detection(header, each, outline) for header, each, outline in drawn if outline is not None]
        newest = header_of(now - min(ages, default=0.0), f"{self._space}/camera")
        self._topic("detections", DETECTIONS).send((newest, detections), now)

    def _topic(self, name: str, kind: str) -> _Topic:
        with self._lock:
            if name not in self._topics:
                number = len(self._topics) + 1
                self._topics[name] = _Topic(self._connection, self._node, number, f"/{self._space}/{name}", kind)
            return self._topics[name]


def _detection(header: tuple[Any, ...], sent: SentTarget, outline: SentOutline) -> tuple[Any, ...]:
    """vision_msgs/Detection2D of a target: the box around its outline."""
    left, top, right, bottom = outline.box
    box = (((left + right) / 2.0, (top + bottom) / 2.0), 0.0), right - left, bottom - top
    pose = NOWHERE if sent.pose is None else pose_with_covariance(sent.pose)
    return header, [((sent.name, outline.support), pose)], box, sent.name

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
from matchset.sharing.sent_targets import NamedLately, SentOutline, SentTarget

CDR = "application/cdr"
ROUTER = "tcp/localhost:7447"
"""Where the router of rmw_zenoh listens, without which nodes of ROS find nobody."""


class _Topic:
    """A publisher of a topic."""

    def __init__(self, connection: Connection, node: RosNode, number: int, topic: str, kind: str) -> None:
        self._encoder, self._number = encoder(kind), 0
        self._keys = node.topic_key(topic, kind), node.publisher_token(number, topic, kind)
        self._identity, self._connection = identity_of(self._keys[1]), connection
        self._send = connection.publisher(self._keys[0], CDR)
        connection.appear(self._keys[1])

    def send(self, values: tuple[Any, ...], now: float) -> None:
        """Send a message, at a time of day in s."""
        self._number += 1
        attached = attachment(self._number, round(NANO * now), self._identity)
        self._send(self._encoder.encode(values), attached)

    def withdraw(self) -> None:
        """Send nothing more: `ros2 topic list` has it no more."""
        self._connection.withdraw(*self._keys)


class RosSender:
    """Sends targets as messages of ROS 2.

    `/left/ball/pose` is a geometry_msgs/PoseWithCovarianceStamped of each target with a pose, `/left/detections` a
    vision_msgs/Detection2DArray of all targets in the picture. Frames are called ``left/camera``: x right, y down, z
    forward, as REP 103 has it of cameras. Stamps are the times of capture on the clock of the day. The topic of a
    target that is gone (`NamedLately`) is withdrawn.

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
        self._connection, self._space = connection, ros_name(name, "_")
        self._node = RosNode(connection.identity, f"matchset_{self._space}", domain)
        self._lock, self._named = threading.RLock(), NamedLately()
        self._topics, self._made = dict[str, _Topic](), 0
        connection.appear(self._node.token)
        self._detections = self._topic("detections", DETECTIONS)

    def send(self, found: Sequence[SentTarget], ages: Sequence[float], clock: float) -> None:
        """Send what was found in a picture, or in several, of these ages, s; `clock`: of the messages, s.

        Raises
        ------
        LinkError
            If the session has ended.
        """
        now = time.time()
        headers = [header_of(now - age, f"{self._space}/camera") for age in ages]
        drawn = [(header, each, each.outline) for header, each in zip(headers, found, strict=True)]
        detections = [_detection(header, each, outline) for header, each, outline in drawn if outline is not None]
        newest = header_of(now - min(ages, default=0.0), f"{self._space}/camera")
        with self._lock:
            self.forget(clock, [each.name for each in found])
            for header, each in zip(headers, found, strict=True):
                if each.pose is not None:
                    if each.name not in self._topics:
                        self._topics[each.name] = self._topic(f"{ros_name(each.name)}/pose", POSE)
                    self._topics[each.name].send((header, pose_with_covariance(each.pose)), now)
            self._detections.send((newest, detections), now)

    def forget(self, clock: float, named: Sequence[str] = ()) -> None:
        """Withdraw the topics of targets that are gone; these are named now, on the clock of the messages, s."""
        with self._lock:
            for name in self._named.gone(named, clock):
                if name in self._topics:
                    self._topics.pop(name).withdraw()

    def _topic(self, name: str, kind: str) -> _Topic:
        self._made += 1
        return _Topic(self._connection, self._node, self._made, f"/{self._space}/{name}", kind)


def _detection(header: tuple[Any, ...], sent: SentTarget, outline: SentOutline) -> tuple[Any, ...]:
    """vision_msgs/Detection2D of a target: the box around its outline."""
    left, top, right, bottom = outline.box
    box = (((left + right) / 2.0, (top + bottom) / 2.0), 0.0), right - left, bottom - top
    pose = NOWHERE if sent.pose is None else pose_with_covariance(sent.pose)
    return header, [((sent.name, outline.support), pose)], box, sent.name

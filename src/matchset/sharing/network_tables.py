"""Targets for robots of FRC, in NetworkTables: `NetworkTables`; the only file that imports ntcore."""

import math
import struct
from collections.abc import Mapping, Sequence
from typing import Any

from matchset.image.errors import LinkError
from matchset.localization.pose import Pose
from matchset.media.closing import Closing
from matchset.numeric.arguments import check_kind, checked_count
from matchset.numeric.copies import NotCopied
from matchset.numeric.imports import advice
from matchset.numeric.words import one_line
from matchset.sharing.clock import Clock, PictureAges
from matchset.sharing.names import checked_name
from matchset.sharing.sent_targets import Named, NamedLately, SentTarget, sent_targets

PORT = 5810  # format: TCP port of NetworkTables 4
NO_PORT = 0  # format: none for NetworkTables 3
LAST_TEAM = 25_599  # format: largest number of a team that has an address, 10.TE.AM.2
MICRO = 1e6  # format: microseconds, in which ntcore counts
POSE_BYTES = struct.Struct("<7d")  # format: struct:Pose3d of WPILib: x, y, z, then w, x, y, z of a quaternion
SCHEMAS = {
    "Translation3d": "double x;double y;double z",
    "Quaternion": "double w;double x;double y;double z",
    "Rotation3d": "Quaternion q",
    "Pose3d": "Translation3d translation;Rotation3d rotation",
}
"""What dashboards read of a type, as WPILib writes it."""


class NetworkTables(NotCopied, Closing):
    """Publishes targets in the NetworkTables of a robot, named as PhotonVision names them; it never waits.

    Below ``/matchset/<name>/<target>/``: `hasTarget`, `latencyMillis`; of an outline `targetPixelsX`, `targetPixelsY`
    and `targetRadius` (half the larger side of its box, px); of a pose `targetYaw` (deg, to the right), `targetPitch`
    (deg, up), `targetPose` (x, y, z in m, and w, x, y, z of the rotation), the same as `targetPose3d`, a struct of
    WPILib, and `targetPoseStd` (m). Robots have x forward, y to the left, z up; all is seen from the camera. A rotation
    that is not observed is none (1, 0, 0, 0), and `rotationObserved` false. Each value has the time at which the
    picture was taken. Of a target that is not published any more `hasTarget` is false, and later nothing is there
    (`NamedLately`).

    Parameters
    ----------
    name : str
        Of this camera: 1 to 64 characters, without ``/ * $ ? # %``.
    server : str, int or None
        Address of the robot, or the number of its team; None: this program is the server itself, on this computer
        alone.
    port : int
        Of the server.
    clock : Clock, optional
        Of pictures, and through sleep.

    Raises
    ------
    ValueError
        If a name or number cannot be.
    LinkError
        If ntcore is not installed.
    """

    def __init__(self, name: str, server: str | int | None, port: int = PORT, *, clock: Clock | None = None) -> None:
        self.name, self._server = checked_name(name), server
        self._publishers, self._named = dict[str, dict[str, Any]](), NamedLately()
        self._stamps = dict[str, int]()
        self._clock = clock or Clock()
        self._ages = PictureAges(self._clock)
        checked_count("the port of NetworkTables", port, 1, 65_535)
        if server is not None:
            check_kind("the server of NetworkTables", server, (str, int))
        if isinstance(server, int):
            checked_count("the number of a team", server, 1, LAST_TEAM)
        try:
            import ntcore
        except ImportError:
            raise LinkError(f"NetworkTables need pyntcore: {advice('frc')}") from None
        self._now, self._options = ntcore._now, ntcore.PubSubOptions(keepDuplicates=True)  # with newer times
        self._tables: Any = ntcore.NetworkTableInstance.create()
        if server is None:
            self._tables.startServer("", "127.0.0.1", NO_PORT, port)
        else:
            self._tables.startClient4(f"matchset {self.name}")
            connect: Any = self._tables.setServerTeam if isinstance(server, int) else self._tables.setServer
            connect(server, port)
        for kind, schema in SCHEMAS.items():
            self._tables.addSchema(f"struct:{kind}", "structschema", schema)

    @property
    def connected(self) -> bool:
        """Whether the robot, or somebody else, is connected."""
        return bool(self._tables.isConnected())

    def publish(self, found: Named, time: float | Mapping[str, float], now: float | None = None) -> None:
        """Publish what was found in a picture; as `Share.publish`.

        Raises
        ------
        ValueError, TypeError
            If that cannot be published. The network raises none.
        """
        targets = sent_targets(found)
        ages = self._ages.of(targets, time, now)
        stamp = self._now()
        for each, age in zip(targets, ages, strict=True):
            self._publish(each, age, max(round(stamp - MICRO * age), 1))
        names = {each.name for each in targets}
        for absent in set(self._publishers) - names:
            self._set(absent, "hasTarget", "Boolean", False, self._stamps[absent] + 1)  # older than its next picture
        for gone in self._named.gone(names, self._clock.now()):
            _end(self._publishers.pop(gone))
            del self._stamps[gone]
        self._tables.flush()

    def close(self) -> None:
        """Publish nothing more."""
        publishers, self._publishers = self._publishers, {}
        for each in publishers.values():
            _end(each)
        if self._tables is not None:
            tables, self._tables = self._tables, None
            type(tables).destroy(tables)

    @one_line
    def __repr__(self) -> str:
        where = "serves itself" if self._server is None else f"to {self._server!r}"
        return f"NetworkTables({self.name!r}, {where})"

    def _publish(self, sent: SentTarget, age: float, stamp: int) -> None:
        name = sent.name
        self._stamps[name] = max(stamp, self._stamps.get(name, stamp))
        self._set(name, "hasTarget", "Boolean", not sent.lost, stamp)
        self._set(name, "latencyMillis", "Double", 1000.0 * age, stamp)
        if sent.outline is not None:
            left, top, right, bottom = sent.outline.box
            self._set(name, "targetPixelsX", "Double", (left + right) / 2.0, stamp)
            self._set(name, "targetPixelsY", "Double", (top + bottom) / 2.0, stamp)
            self._set(name, "targetRadius", "Double", max(right - left, bottom - top) / 2.0, stamp)
        if sent.pose is not None:
            x, y, z = sent.pose.position.tolist()
            self._set(name, "targetYaw", "Double", math.degrees(math.atan2(x, z)), stamp)
            self._set(name, "targetPitch", "Double", math.degrees(math.atan2(-y, math.hypot(x, z))), stamp)
            pose = robot_pose(sent.pose)
            self._set(name, "targetPose", "DoubleArray", pose, stamp)
            self._set(name, "targetPose3d", "Raw", POSE_BYTES.pack(*pose), stamp)
            self._set(name, "targetPoseStd", "DoubleArray", robot_deviations(sent.pose), stamp)
            self._set(name, "rotationObserved", "Boolean", sent.pose.rotation is not None, stamp)

    def _set(self, name: str, value_name: str, kind: str, value: Any, stamp: int) -> None:
        publishers = self._publishers.setdefault(name, {})
        if value_name not in publishers:
            made = getattr(self._tables, f"get{kind}Topic")(f"/matchset/{self.name}/{name}/{value_name}")
            publishers[value_name] = made.publish(*["struct:Pose3d"] * (kind == "Raw"), self._options)
        publishers[value_name].set(value, stamp)


def _end(publishers: Mapping[str, Any]) -> None:
    """Withdraw what was published of a target."""
    for each in publishers.values():
        each.close()


def robot_pose(pose: Pose) -> Sequence[float]:
    """Return a pose in a robot's axes (x forward, y left, z up): x, y, z, m, and w, x, y, z of its quaternion.

    Both frames, that of the camera and that of the ball, are turned into the robot's axes: of a ball whose marker
    looks at the camera, without tilt, w is 0, half a turn about z.
    """
    x, y, z = pose.position.tolist()
    if pose.rotation is None:
        return [z, -x, -y, 1.0, 0.0, 0.0, 0.0]
    i, j, k, w = pose.rotation.as_quat(canonical=True).tolist()
    return [z, -x, -y, w, k, -i, -j]


def robot_deviations(pose: Pose) -> Sequence[float]:
    """Return the standard deviations of x, y and z in a robot's axes, m."""
    variances = pose.covariance.diagonal().tolist()
    return [math.sqrt(max(variances[axis], 0.0)) for axis in (2, 0, 1)]

"""What a robot reads in NetworkTables: by ntcore's own server, and by its own client where matchset serves."""

import functools
import socket
import struct
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import matchset as ms
from matchset.sharing.clock import Clock
from matchset.sharing.messages import MOST_TARGETS
from matchset.sharing.network_tables import robot_deviations, robot_pose
from matchset.sharing.sent_targets import Shareable
from sharing_poses import FULL, LEVEL, TRACK
from sharing_processes import until

ntcore = pytest.importorskip("ntcore", reason="pyntcore, the extra `frc`, is not installed")
TO_ROBOT = np.array(((0.0, 0.0, 1.0), (-1.0, 0.0, 0.0), (0.0, -1.0, 0.0)))
"""From the camera's axes (right, down, forward) to the robot's (forward, left, up)."""


@pytest.fixture
def port() -> int:
    with socket.socket() as there:
        there.bind(("127.0.0.1", 0))
        return int(there.getsockname()[1])


@pytest.fixture
def robot() -> Iterator[Any]:
    made = ntcore.NetworkTableInstance.create()
    yield made
    ntcore.NetworkTableInstance.destroy(made)


def test_the_server_of_a_robot_reads_everything(robot: Any, port: int) -> None:
    robot.startServer("", "127.0.0.1", 0, port)
    begin = "/matchset/left/ball/"
    names = ("latencyMillis", "targetPixelsX", "targetPixelsY", "targetRadius", "targetYaw", "targetPitch")
    numbers = {name: robot.getDoubleTopic(begin + name).subscribe(-1.0) for name in names}
    seen = robot.getBooleanTopic(begin + "hasTarget").subscribe(False)
    turned = robot.getBooleanTopic(begin + "rotationObserved").subscribe(False)
    pose = robot.getDoubleArrayTopic(begin + "targetPose").subscribe([])
    late = robot.getDoubleArrayTopic("/matchset/left/late/targetPose").subscribe([])
    std = robot.getDoubleArrayTopic(begin + "targetPoseStd").subscribe([])
    raw = robot.getRawTopic(begin + "targetPose3d").subscribe("struct:Pose3d", b"")
    with ms.NetworkTables("left", "127.0.0.1", port) as tables:
        found: dict[str, Shareable] = {"ball": (TRACK, FULL), "late": LEVEL}
        tables.publish(found, {"ball": 10.0, "late": 9.0}, 10.25)
        until(lambda: turned.get() and raw.get() and late.get())
        assert tables.connected
        assert seen.get() is True
        assert numbers["latencyMillis"].get() == 250.0
        assert numbers["targetPixelsX"].get() == pytest.approx(70.5, abs=0.05)
        assert numbers["targetPixelsY"].get() == pytest.approx(50.25, abs=0.05)
        assert numbers["targetRadius"].get() == pytest.approx(25.0, abs=0.05)
        x, y, z = FULL.position
        assert numbers["targetYaw"].get() == pytest.approx(np.degrees(np.arctan2(x, z)))
        assert numbers["targetPitch"].get() == pytest.approx(np.degrees(np.arctan2(-y, np.hypot(x, z))))
        assert pose.get() == robot_pose(FULL)
        assert std.get() == robot_deviations(FULL)
        assert struct.unpack("<7d", raw.get()) == tuple(robot_pose(FULL))
        schema = robot.getRawTopic("/.schema/struct:Pose3d").subscribe("structschema", b"")
        until(lambda: schema.get() == b"Translation3d translation;Rotation3d rotation")
        assert pose.getAtomic().time - late.getAtomic().time == pytest.approx(1e6, abs=2.0)
        tables.publish({"ball": ms.Lost("hidden", 0.0)}, 11.0, 11.25)
        until(lambda: not seen.get())
        assert pose.get() == robot_pose(FULL)
        tables.publish(found, {"ball": 12.0, "late": 11.0}, 12.25)
        until(lambda: seen.get())
        tables.publish({"late": LEVEL}, 12.0, 12.25)  # one that is not told any more is not there any more
        until(lambda: not seen.get())


def test_a_target_is_there_again_after_pictures_without_it(robot: Any, port: int) -> None:
    robot.startServer("", "127.0.0.1", 0, port)
    seen = robot.getBooleanTopic("/matchset/left/ball/hasTarget").subscribe(False)
    with ms.NetworkTables("left", "127.0.0.1", port) as tables:
        for found, there in ((LEVEL, True), ({}, False), (LEVEL, True), (LEVEL, True)):
            tables.publish(found, 10.0, 15.0)  # 5 s old: longer than what happens here takes
            until(functools.partial(lambda wanted: seen.get() == wanted, there))
        tables.publish(LEVEL, 10.0, 20.0)  # one from before goes nowhere, that it is gone is told
        tables.publish({}, 10.0, 20.0)
        until(lambda: not seen.get())


def test_values_of_targets_that_are_gone_are_withdrawn(robot: Any, port: int) -> None:
    robot.startServer("", "127.0.0.1", 0, port)
    listener = ntcore.MultiSubscriber(robot, ["/matchset/"])
    passed, right = [0.0], Clock()
    clock = Clock(lambda: right.now() + passed[0], lambda: right.awake() + passed[0])

    def told() -> set[str]:
        return {each.getName().split("/")[3] for each in robot.getTopics("/matchset/left/") if each.exists()}

    with ms.NetworkTables("left", "127.0.0.1", port, clock=clock) as tables:
        until(lambda: tables.connected)
        for number in range(200):
            tables.publish({f"ball {number}": FULL, "kept": LEVEL}, 10.0, 10.0)
            assert len(tables._publishers) <= MOST_TARGETS
        tables.publish({"kept": LEVEL}, 10.0, 10.0)
        until(lambda: len(told()) == MOST_TARGETS)
        passed[0] = 11.0
        tables.publish({"kept": ms.Lost("hidden", 0.0)}, 10.0, 10.0)
        until(lambda: told() == {"kept"})
        tables.publish({"ball 3": FULL}, 10.0, 10.0)
        until(lambda: told() == {"kept", "ball 3"})
    listener.close()


def test_it_serves_where_there_is_no_robot(robot: Any, port: int) -> None:
    with ms.NetworkTables("left", None, port) as tables:
        tables.publish(LEVEL, 10.0, 10.0)
        robot.startClient4("a dashboard")
        robot.setServer("127.0.0.1", port)
        pose = robot.getDoubleArrayTopic("/matchset/left/ball/targetPose").subscribe([])
        until(lambda: pose.get() == robot_pose(LEVEL))
        assert repr(tables) == "NetworkTables('left', serves itself)"


def test_without_a_robot_nothing_waits_and_nothing_is_raised(port: int) -> None:
    with ms.NetworkTables("left", "127.0.0.1", port) as tables:
        for time in range(100):
            tables.publish(LEVEL, float(time), float(time))
        assert not tables.connected
    tables.close()


@pytest.mark.parametrize("turn", [(0.0, 0.0, 0.0), (0.3, 0.0, 0.0), (0.1, -2.0, 0.4), (0.0, np.pi, 0.0)])
def test_a_pose_is_turned_into_the_axes_of_a_robot(turn: tuple[float, float, float]) -> None:
    matrix = Rotation.from_rotvec(turn).as_matrix()
    pose = ms.Pose(
        position=np.array((0.1, -0.2, 1.9)),
        rotation_matrix=matrix,
        covariance=np.diag((1.0, 4.0, 9.0, 1.0, 1.0, 1.0)),
        observed="full",
        time=0.0,
    )
    x, y, z, w, i, j, k = robot_pose(pose)
    assert (x, y, z) == (1.9, -0.1, 0.2)
    assert np.allclose(Rotation.from_quat((i, j, k, w)).as_matrix(), TO_ROBOT @ matrix @ TO_ROBOT.T)
    assert robot_deviations(pose) == [3.0, 1.0, 2.0]
    assert robot_pose(LEVEL)[3:] == [1.0, 0.0, 0.0, 0.0]


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"name": "a/b"}, "got 'a/b'"),
        ({"server": 0}, "the number of a team must be a whole number, 1 to 25599"),
        ({"port": 0}, "the port of NetworkTables must be a whole number"),
    ],
)
def test_misuse_is_refused(wrong: dict[str, Any], words: str) -> None:
    with pytest.raises(ValueError, match=words):
        ms.NetworkTables(**({"name": "left", "server": "127.0.0.1"} | wrong))


def test_a_time_that_is_not_finite_is_refused(port: int) -> None:
    with ms.NetworkTables("left", None, port) as tables, pytest.raises(ValueError, match="times must be finite"):
        tables.publish(LEVEL, float("nan"))


def test_without_ntcore_it_says_what_to_install(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ntcore", None)
    with pytest.raises(ms.LinkError, match="NetworkTables need pyntcore: pip install 'pyntcore"):
        ms.NetworkTables("left", None)

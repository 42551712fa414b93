"""Poses sent to an autopilot: what it receives, of `PosePublisher` and of the command."""

import functools
import math
import socket
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from fake_autopilot import PX4, FakeAutopilot
from scipy.spatial.transform import Rotation

from blue_ball import Matchset
from marked_balloon import BLUE, FOV_DEG, FRAMES, PURPLE, flight, write_video
from matchset.app.adapters.mavlink_poses import PosePublisher, PublishParameters, parse_publisher
from matchset.app.locate.rows import read_poses
from matchset.image.errors import LinkError
from matchset.links.mavlink.axes import CameraAxes
from matchset.links.mavlink.client import MavlinkParameters
from matchset.links.mavlink.packet import MavlinkPacket, MavlinkParser, PacketWriter
from matchset.localization.pose import Pose
from matchset.tracking.track import Lost

URI = "mavlink:udpout:127.0.0.1:14550"
TURN = Rotation.from_euler("y", 170.0, degrees=True).as_matrix()
BALL = Pose(
    position=np.array((0.2, -0.1, 3.0)), rotation_matrix=None, covariance=np.eye(6), observed="position", time=2.0
)
SEEN = Pose(position=np.array((0.2, -0.1, 3.0)), rotation_matrix=TURN, covariance=np.eye(6), observed="full", time=2.0)


class Listener(FakeAutopilot):
    """Keeps all that it hears."""

    def __post_init__(self) -> None:
        super().__post_init__()
        self.packets: list[MavlinkPacket] = []
        self._ears = MavlinkParser()

    def write(self, data: bytes) -> None:
        super().write(data)
        self.packets += self._ears.feed(data)

    def got(self, name: str) -> list[dict[str, Any]]:
        return [packet.values for packet in self.packets if packet.message.name == name]


def published(kind: Any, pose: Pose, **facts: Any) -> tuple[PosePublisher, Listener]:
    pilot = Listener(**facts)
    parameters = PublishParameters(kind=kind, mount=CameraAxes(forward=0.1))
    publisher = PosePublisher(URI, parameters, pilot, pilot.clock, pilot.clock.sleep)
    publisher.send(pose, 5.0)
    return publisher, pilot


@pytest.mark.parametrize(
    ("kind", "name", "x"),
    [
        ("odometry-ball", "ODOMETRY", 3.1),
        ("odometry-camera", "ODOMETRY", None),
        ("landing-target", "LANDING_TARGET", 3.1),
        ("target-relative", "TARGET_RELATIVE", 3.1),
    ],
)
def test_each_kind_sends_its_message(kind: str, name: str, x: float | None) -> None:
    publisher, pilot = published(kind, SEEN)
    (values,) = pilot.got(name)
    assert x is None or values["x"] == pytest.approx(x)
    assert values.get("time_usec", values.get("timestamp")) == 5_000_000
    assert (publisher.sent, publisher.skipped) == (1, 0)


def test_it_is_a_part_of_the_vehicle_and_sends_no_sticks() -> None:
    _, pilot = published("odometry-ball", SEEN, system=7)
    assert {(packet.system, packet.component) for packet in pilot.packets if packet.message.name == "ODOMETRY"} == {
        (7, 197)
    }
    assert pilot.got("MANUAL_CONTROL") == []
    assert {command for command, _ in pilot.asked} == {511}
    pilot.packets.clear()
    publisher, pilot = published("odometry-ball", SEEN)
    for _ in range(90):
        pilot.clock.sleep(0.033)
        publisher.send(SEEN)
    assert {values["type"] for values in pilot.got("HEARTBEAT")} == {18}
    assert {each.component for each in pilot.packets} == {197}


def test_a_ball_that_is_lost_or_lacks_its_rotation_is_not_sent() -> None:
    publisher, pilot = published("odometry-camera", BALL)
    assert publisher.send(Lost("hidden", 2.0)) is False
    assert pilot.got("ODOMETRY") == []
    assert (publisher.sent, publisher.skipped) == (0, 2)


@pytest.mark.parametrize(("autopilot", "is_nan"), [(PX4, True), (3, False)])
def test_an_attitude_that_is_not_known_is_said_as_the_autopilot_takes_it(autopilot: int, is_nan: bool) -> None:
    _, pilot = published("odometry-ball", BALL, autopilot=autopilot)
    (values,) = pilot.got("ODOMETRY")
    assert math.isnan(values["q"][0]) == is_nan
    assert values["pose_covariance"][20] == pytest.approx(math.pi**2 / 3.0)


def test_the_vehicle_s_attitude_goes_with_a_target() -> None:
    publisher, pilot = published("target-relative", SEEN)
    pilot.clock.sleep(0.2)
    publisher.send(SEEN)
    assert pilot.got("TARGET_RELATIVE")[-1]["q_sensor"] != (0.0,) * 4


def test_a_ground_station_of_our_number_does_not_matter() -> None:
    pilot = Listener()
    pilot._out += PacketWriter(255, 190).write("HEARTBEAT", {"type": 6, "autopilot": 8})
    PosePublisher(URI, None, pilot, pilot.clock, pilot.clock.sleep)


def test_silence_and_a_port_that_is_gone_are_said() -> None:
    publisher, pilot = published("odometry-ball", SEEN)
    pilot.clock.sleep(0.5)
    pilot.mute = True
    pilot.clock.sleep(3.0)
    with pytest.raises(LinkError, match="silent"):
        publisher.send(SEEN)
    pilot.unplugged = True
    with pytest.raises(LinkError, match="has gone"):
        publisher.send(SEEN)
    with publisher:
        pass
    assert pilot.closed
    with pytest.raises(LinkError, match="no autopilot is heard"):
        PosePublisher(URI, None, pilot := Listener(mute=True), pilot.clock, pilot.clock.sleep)
    assert pilot.closed


def test_a_uri_says_what_is_sent() -> None:
    uri, parameters = parse_publisher(URI + "?as=landing-target&pitch=-90&forward=0.1&vehicle=2&marker=0", 0.2)
    assert uri == URI + "?vehicle=2"
    assert parameters.mount.pitch == pytest.approx(-math.pi / 2)
    assert (parameters.mount.forward, parameters.diameter, parameters.marker_heading) == (0.1, 0.2, 0.0)
    assert parse_publisher(URI) == (URI, PublishParameters())


@pytest.mark.parametrize(
    ("question", "words"),
    [
        ("as=pose", "a pose is sent as odometry-ball, .* got 'pose'"),
        ("pitch=down", "pitch must be a number, got 'down'"),
        ("pitch=nan", "pitch of a camera's mount must be finite"),
        ("marker=inf", "heading and a diameter must be finite"),
        ("speed=3", "come vehicle, system, mode, got 'speed'"),
    ],
)
def test_what_a_uri_cannot_say_is_refused(question: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        parse_publisher(f"{URI}?{question}")


@pytest.fixture
def autopilot() -> Iterator[tuple[int, list[MavlinkPacket]]]:
    """An autopilot at a UDP port, which says that it is there and keeps what it hears."""
    done, packets, parser = threading.Event(), [], MavlinkParser()
    heart = PacketWriter(1, 1)
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as there:
        there.bind(("127.0.0.1", 0))
        there.settimeout(0.2)

        def live() -> None:
            while not done.is_set():
                try:
                    data, sender = there.recvfrom(1000)
                except TimeoutError:
                    continue
                packets.extend(parser.feed(data))
                there.sendto(heart.write("HEARTBEAT", {"type": 2, "autopilot": 12}), sender)

        thread = threading.Thread(target=live)
        thread.start()
        try:
            yield there.getsockname()[1], packets
        finally:
            done.set()
            thread.join()


@pytest.fixture(scope="module")
def flown(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("flight") / "flight.avi"
    write_video(str(path), flight())
    return path


@pytest.mark.usefixtures("no_path_picture")
def test_the_command_sends_every_pose(
    matchset: Matchset, flown: Path, autopilot: tuple[int, list[MavlinkPacket]], capsys: pytest.CaptureFixture[str]
) -> None:
    number, packets = autopilot
    where = f"mavlink:udpout:127.0.0.1:{number}?as=landing-target"
    options = "--fov", f"{FOV_DEG}", "--diameter", "0.28", "--pick", BLUE, "--marker-pick", PURPLE, "--no-video"
    assert matchset("locate", flown, *options, "--mavlink", where) == 0
    targets = [packet.values for packet in packets if packet.message.name == "LANDING_TARGET"]
    rows = read_poses("runs/0001-locate/poses.csv")
    assert len(targets) == len(rows) == FRAMES
    for target, row in zip(targets, rows, strict=True):
        assert row.values is not None
        assert (target["x"], target["y"], target["z"]) == pytest.approx([row.values[name] for name in "zxy"], abs=1e-4)
    assert "error" not in capsys.readouterr().err


def test_a_wrong_uri_and_an_autopilot_that_is_not_there_end_the_command(
    matchset: Matchset, flown: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    hasty = functools.partial(MavlinkParameters, startup_timeout=0.3)
    monkeypatch.setattr("matchset.app.adapters.mavlink_poses.MavlinkParameters", hasty)
    options = "--fov", f"{FOV_DEG}", "--diameter", "0.28", "--pick", BLUE, "--no-video"
    assert matchset("locate", flown, *options, "--mavlink", "udp:1") == 2
    assert "an autopilot is named like" in capsys.readouterr().err
    assert not Path("runs").exists()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as nobody:
        nobody.bind(("127.0.0.1", 0))
        where = f"mavlink:udpout:127.0.0.1:{nobody.getsockname()[1]}"
        assert matchset("locate", flown, *options, "--mavlink", where) == 3
    assert capsys.readouterr().err == f"error: {where}: no autopilot is heard (waited 0.3 s)\n"

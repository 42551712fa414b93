"""A vehicle whose MAVLink is MAVSDK's, flown over a real UDP socket in real time; `.ci/setup-mavlink` makes its place.

Its server plugins arm, change modes as PX4 and speak. Their heartbeat says neither type nor autopilot: those two fields
are filled in on the way.
"""

import json
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from matchset.control.command import Command
from matchset.image.errors import LinkError
from matchset.links.mavlink.address import Address
from matchset.links.mavlink.axes import CameraAxes
from matchset.links.mavlink.client import MavlinkParameters
from matchset.links.mavlink.estimates import landing_target, odometry_of_ball
from matchset.links.mavlink.mavlink_link import MavlinkLink
from matchset.links.mavlink.packet import MavlinkParser, PacketWriter
from matchset.links.mavlink.ports import UdpPort
from matchset.localization.pose import Pose

ROOT = Path(__file__).resolve().parents[3]
PEERS = ROOT / ".mavlink"
QUADROTOR_OF_PX4 = {"type": 2, "autopilot": 12}

pytestmark = pytest.mark.skipif(not (PEERS / "ready").exists(), reason="MAVSDK is missing: run .ci/setup-mavlink")


class NamedPort(UdpPort):
    """Fills in type and autopilot of the heartbeats that pass."""

    def read(self) -> list[tuple[str, bytes]]:
        return [(sender, self._named(data)) for sender, data in super().read()]

    def _named(self, data: bytes) -> bytes:
        found = MavlinkParser().feed(data)
        if len(found) != 1 or found[0].message.name != "HEARTBEAT":
            return data
        packet = found[0]
        writer = PacketWriter(packet.system, packet.component)
        for _ in range(data[4]):  # its sequence number
            writer.write("HEARTBEAT", {})
        return writer.write("HEARTBEAT", packet.values | QUADROTOR_OF_PX4)


class Vehicle:
    """The program, and all that it told."""

    def __init__(self, port: int) -> None:
        program = Path(__file__).with_name("peer_mavsdk.py")
        command = [str(PEERS / "bin" / "python"), str(program), str(port)]
        quiet = subprocess.DEVNULL
        self._program = subprocess.Popen(
            command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=quiet, text=True
        )
        self.told: list[dict[str, Any]] = []
        self._thread = threading.Thread(target=self._listen)
        self._thread.start()

    def say(self, line: str) -> None:
        assert self._program.stdin is not None
        self._program.stdin.write(line + "\n")
        self._program.stdin.flush()

    def received(self, name: str) -> list[dict[str, Any]]:
        return [each["fields"] for each in list(self.told) if each.get("name") == name]

    def close(self) -> None:
        self._program.kill()
        self._thread.join()
        self._program.communicate()

    def _listen(self) -> None:
        assert self._program.stdout is not None
        for line in self._program.stdout:
            if line.startswith("{"):  # the library talks, too
                self.told.append(json.loads(line))


@pytest.fixture
def flown() -> Iterator[tuple[MavlinkLink, Vehicle]]:
    probe = UdpPort(Address("udpin", "127.0.0.1", 0))
    number = probe._socket.getsockname()[1]
    probe.close()
    address = Address("udpin", "127.0.0.1", number)
    port = NamedPort(address)
    vehicle = Vehicle(number)
    link = None
    try:
        patient = MavlinkParameters(startup_timeout=60.0)  # a program that starts on a busy computer
        link = MavlinkLink(f"mavlink:udpin:127.0.0.1:{number}", port, patient)
        yield link, vehicle
    finally:
        if link is not None:
            link.close()
        vehicle.close()


def until(link: MavlinkLink, done: Callable[[], bool], command: Command | None = None, limit: float = 5.0) -> None:
    end = time.monotonic() + limit
    while not done():
        assert time.monotonic() < end
        if command is not None:
            link.send(command)
        link.status()
        time.sleep(0.03)


def test_it_arms_flies_and_lands(flown: tuple[MavlinkLink, Vehicle]) -> None:
    link, vehicle = flown
    link.arm()
    assert link.status().state == "armed"
    assert link.status().version == "PX4, vehicle 1"
    assert {"arm": True, "force": False} in vehicle.told
    command = Command(0.25, -0.5, 0.75, 0.6)
    until(link, lambda: any(each["z"] == 600 for each in vehicle.received("MANUAL_CONTROL")), command)
    sticks = next(each for each in vehicle.received("MANUAL_CONTROL") if each["z"])
    assert {name: sticks[name] for name in ("target", "x", "y", "z", "r")} == {
        "target": 1,
        "x": -500,
        "y": 250,
        "z": 600,
        "r": 750,
    }
    link.land(0.5)
    assert link.status().state == "locked"
    assert {"arm": False, "force": False} in vehicle.told
    assert vehicle.received("MANUAL_CONTROL")[-1]["z"] == 0
    assert link.client.lost == 0


def test_its_refusal_is_passed_on(flown: tuple[MavlinkLink, Vehicle]) -> None:
    link, vehicle = flown
    vehicle.say("armable 0")
    vehicle.say("text PreArm: no GPS")
    until(link, lambda: "PreArm: no GPS" in link.status().warnings)
    vehicle.say("text PreArm: still no GPS")
    with pytest.raises(LinkError, match=r"arming refused by PX4 .*"):
        link.arm()
    assert link.status().state == "locked"
    vehicle.say("armable 1")
    time.sleep(0.2)
    link.arm()
    assert link.status().state == "armed"


def test_a_cut_is_by_force(flown: tuple[MavlinkLink, Vehicle]) -> None:
    link, vehicle = flown
    link.arm()
    link.cut()
    until(link, lambda: {"arm": False, "force": True} in vehicle.told, Command(throttle=0.5))
    until(link, lambda: link.status().state == "locked", Command(throttle=0.5))


def test_one_that_disarms_by_itself_is_noticed(flown: tuple[MavlinkLink, Vehicle]) -> None:
    link, vehicle = flown
    link.arm()
    vehicle.say("disarm")
    until(link, lambda: link.status().state == "failsafe", Command(throttle=0.5))
    assert link.status().refusal.startswith("PX4 disarmed")
    assert link.send(Command(throttle=0.5)) == Command()


def test_poses_are_read_alike(flown: tuple[MavlinkLink, Vehicle]) -> None:
    link, vehicle = flown
    turn = Rotation.from_euler("xyz", (0.2, 2.8, -0.1)).as_matrix()
    seen = Pose(
        position=np.array((0.3, -0.4, 2.5)), rotation_matrix=turn, covariance=np.eye(6), observed="full", time=1.0
    )
    mount = CameraAxes(pitch=-0.5)
    odometry = odometry_of_ball(seen, mount, 0.0, 7.0)
    target = landing_target(seen, mount, 0.28, 7.0)
    until(link, lambda: {"listening": True} in vehicle.told)
    link.client.write("ODOMETRY", odometry)
    link.client.write("LANDING_TARGET", target)
    until(link, lambda: bool(vehicle.received("LANDING_TARGET") and vehicle.received("ODOMETRY")))
    for values, read in ((odometry, vehicle.received("ODOMETRY")[0]), (target, vehicle.received("LANDING_TARGET")[0])):
        for name, value in values.items():
            theirs = read[name]
            if name in ("vx", "vy", "vz", "rollspeed", "pitchspeed", "yawspeed", "velocity_covariance"):
                continue  # NaN, which JSON lacks
            assert theirs == pytest.approx(list(value) if isinstance(value, tuple) else value, rel=1e-5), name


def test_one_that_stops_is_silent(flown: tuple[MavlinkLink, Vehicle]) -> None:
    link, vehicle = flown
    link.arm()
    vehicle.close()
    with pytest.raises(LinkError, match=r"vehicle 1 has been silent for 2\.5 s"):
        until(link, lambda: False, Command(throttle=0.5))

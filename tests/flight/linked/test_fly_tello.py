"""`matchset fly --link tello:...`: what a Tello is told, and how a follower flies one in numbers."""

import math
import socket
from collections.abc import Iterator

import msgspec
import numpy as np
import pytest
from fake_tello import FakeTello, ServedTello
from fakes import Clock
from scipy.spatial.transform import Rotation

from matchset.control.command import Command
from matchset.control.follower import Follower, FollowerParameters, RelativeSetpoint
from matchset.control.safety import SafetyInputs, SafetyState, safety_filter
from matchset.flight.chain.config import with_world
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.linked.parameters import LinkedFollower
from matchset.flight.linked.vehicle_kind import for_links, start_video, told_to
from matchset.links.tello.tello_client import TelloParameters
from matchset.links.tello.tello_link import TelloLink
from matchset.localization.pose import Pose

TELLO = "tello:127.0.0.1"
TAKEOFF = TelloParameters().takeoff_time


def free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as there:
        there.bind(("", 0))
        return int(there.getsockname()[1])


@pytest.fixture
def served() -> Iterator[tuple[ServedTello, str]]:
    states = free_port()
    tello = ServedTello(states)
    try:
        yield tello, f"{TELLO}?commands={tello.port}&states={states}"
    finally:
        tello.close()


def test_links_decide_what_a_vehicle_is_told() -> None:
    flight = FlightParameters()
    assert for_links(flight, ["serial:///dev/ttyUSB0"]) is flight
    told = for_links(flight, ["tello:", "tello:192.168.1.23"])
    follower = told.loop.follower
    assert (follower.commands, follower.ego_motion.speed_commands, follower.speeds.takeoff_duration) == (
        "speeds",
        True,
        TAKEOFF,
    )
    assert follower.horizontal == follower.speeds.horizontal
    slow = msgspec.structs.replace(
        flight.pilot.follower, speeds=msgspec.structs.replace(follower.speeds, takeoff_duration=9.0)
    )
    slower = msgspec.structs.replace(flight, pilot=msgspec.structs.replace(flight.pilot, follower=slow))
    assert for_links(slower, ["tello:"]).loop.follower.speeds.takeoff_duration == 9.0
    assert [told_to(uri) for uri in ("tello:", "crsf:///dev/ttyUSB0")] == ["speeds", "angles"]
    with pytest.raises(
        ValueError, match="tello: is told speeds, crsf:///x angles and thrust: fly them by two programs"
    ):
        for_links(flight, ["tello:", "crsf:///x"])
    with pytest.raises(ValueError, match=r'commands = "speeds": --link crsf:///x tells angles and thrust'):
        for_links(with_world(flight, commands="speeds"), ["crsf:///x"])
    with pytest.raises(ValueError, match="commands"):
        FlightParameters(pilot=msgspec.structs.replace(flight.pilot, follower=FollowerParameters(commands="speeds")))


def test_its_own_video_is_started_where_it_is_the_camera(served: tuple[ServedTello, str]) -> None:
    tello, uri = served
    start_video(LinkedFollower(camera=0, link=uri))
    start_video(LinkedFollower(camera="udp://0.0.0.0:11111", link="crsf:///dev/ttyUSB0"))
    assert tello.tello.heard == []
    start_video(LinkedFollower(camera="udp://0.0.0.0:11111", link=uri))
    assert "streamon" in tello.tello.heard
    assert not {"takeoff", "land", "streamoff"} & set(tello.tello.heard)


class Flown:
    """A follower, the safety filter and a Tello in numbers on one clock; the ball is where the test says."""

    def __init__(self) -> None:
        self.clock = Clock()
        self.tello = FakeTello(self.clock)
        self.link = TelloLink("tello:", self.tello, clock=self.clock, sleep=self.clock.sleep)
        follower = for_links(FlightParameters(), ["tello:"]).loop.follower
        self.follower = Follower(RelativeSetpoint(), follower)
        self.safety, self.command = SafetyState(), Command()
        self.link.arm()

    def fly(self, seconds: float, ball: tuple[float, float, float], fault: str = "", turned: float = 0.0) -> None:
        """Fly by a ball that is seen at a place before the camera, whatever the vehicle does."""
        for _ in range(round(30 * seconds)):
            now = self.clock()
            control = self.follower.update(seen(ball, now, turned), now)
            holds = self.follower.sticks.hold_throttle
            inputs = SafetyInputs(now, now, now, True, fault, hover=self.follower.hover_throttle, hold_throttle=holds)
            wanted, self.safety = safety_filter(control and control.desired, inputs, self.safety)
            self.command = self.link.send(wanted)
            self.follower.sent(self.command, now)
            self.clock.sleep(1.0 / 30.0)

    def fly_beside(self, seconds: float, ball: tuple[float, float, float]) -> None:
        """Fly by a ball in the room: to the right of where it took off, above the floor, and before it, m."""
        for _ in range(round(30 * seconds)):
            (x, z), turned = self.tello.place, math.radians(self.tello.yaw)
            right, ahead = ball[0] - x, ball[2] - z
            cos, sin = math.cos(turned), math.sin(turned)
            place = right * cos - ahead * sin, self.tello.height - ball[1], right * sin + ahead * cos
            self.fly(1.0 / 30.0, place, turned=turned)

    @property
    def told(self) -> tuple[int, ...]:
        """Sticks that the Tello heard last: right, forward, up, clockwise."""
        return next(tuple(map(int, each.split()[1:])) for each in self.tello.heard[::-1] if each.startswith("rc"))


def seen(place: tuple[float, float, float], time: float, turned: float) -> Pose:
    """A ball whose marker looks backward in the room, seen by a vehicle that has turned to the right."""
    turn = Rotation.from_euler("y", math.pi - turned).as_matrix()
    spread = np.diag((1e-6,) * 3 + (1e-4,) * 3)
    return Pose(position=np.array(place), rotation_matrix=turn, covariance=spread, observed="level", time=time)


@pytest.mark.parametrize(
    ("ball", "stick", "sign"),
    [
        ((0.25, 0.0, 1.5), 0, 1),
        ((-0.25, 0.0, 1.5), 0, -1),
        ((0.0, 0.0, 1.65), 1, 1),
        ((0.0, 0.0, 1.35), 1, -1),
        ((0.0, -0.2, 1.5), 2, 1),
        ((0.0, 0.2, 1.5), 2, -1),
        ((0.25, 0.0, 1.5), 3, 1),
        ((-0.25, 0.0, 1.5), 3, -1),
    ],
)
def test_it_is_told_to_go_where_the_ball_is(ball: tuple[float, float, float], stick: int, sign: int) -> None:
    flown = Flown()
    flown.fly(TAKEOFF, ball)
    assert all(each == 0 for each in flown.told)
    flown.fly(0.5, ball)
    assert flown.safety.phase == "flying"
    assert flown.tello.heard.count("takeoff") == 1
    size = sign * flown.told[stick]
    assert (2 if stick == 3 else 15) <= size <= 90


def test_at_its_place_it_is_told_to_stand_still() -> None:
    flown = Flown()
    flown.fly(TAKEOFF + 3.0, (0.0, 0.0, 1.5))
    assert all(abs(each) <= 2 for each in flown.told)


@pytest.mark.parametrize("ball", [(0.0, 0.9, 1.5), (0.4, 1.2, 1.8), (-0.3, 0.7, 1.1)])
def test_it_comes_to_its_place_beside_a_ball_in_the_room(ball: tuple[float, float, float]) -> None:
    flown = Flown()
    flown.fly_beside(25.0, ball)
    assert flown.safety.phase == "flying"
    x, z = flown.tello.place
    away = math.hypot(ball[0] - x, ball[2] - z)
    assert away == pytest.approx(1.5, abs=0.03)
    assert x == pytest.approx(ball[0], abs=0.03)
    assert flown.tello.height == pytest.approx(ball[1], abs=0.05)
    assert math.radians(flown.tello.yaw) == pytest.approx(math.atan2(ball[0] - x, ball[2] - z), abs=0.06)


def test_while_it_takes_off_no_stick_is_told_and_nothing_is_learned() -> None:
    flown = Flown()
    flown.fly(1.2, (0.2, 0.0, 1.7))
    assert flown.tello.doing == "takeoff"
    assert not [each for each in flown.tello.heard if each.startswith("rc")]
    assert flown.command == Command(throttle=0.5)
    assert flown.follower.ego_motion.at(flown.clock()).velocity == pytest.approx([0.0, 0.0, 0.0])


def test_a_descent_sinks_slowly_then_it_lands_by_itself() -> None:
    flown = Flown()
    flown.fly(TAKEOFF + 3.0, (0.1, -0.1, 1.6))
    flown.tello.height = 1.6  # so that it does not touch down before
    flown.fly(1.9, (0.1, -0.1, 1.6), fault="the picture stands still")
    phases = [flown.safety.phase]
    right, forward, up, clockwise = flown.told
    assert (right, forward, clockwise) == (0, 0, 0)
    assert -26 <= up <= -20
    assert "land" not in flown.tello.heard
    assert flown.tello.motors
    flown.fly(5.0, (0.1, -0.1, 1.6), fault="the picture stands still")
    phases.append(flown.safety.phase)
    assert phases == ["descending", "cut"]
    assert flown.tello.heard.count("land") == 1
    assert "emergency" not in flown.tello.heard
    assert not flown.tello.motors

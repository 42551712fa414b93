"""Devices of a preflight that exist in numbers: a camera before a rendered ball, links, a person, on one clock."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from fake_autopilot import FakeAutopilot
from fake_tello import FakeTello
from fakes import Clock, FakePort
from scipy.spatial.transform import Rotation

from matchset.flight.linked.options import LinkedOptions
from matchset.flight.preflight.moves import MOVES
from matchset.flight.preflight.options import PreflightOptions
from matchset.flight.preflight.parameters import PreflightParameters
from matchset.flight.preflight.sequence import Bench
from matchset.image.errors import LinkError
from matchset.image.frame import Frame
from matchset.links.arduino.arduino_link import ArduinoLink
from matchset.links.crsf.crsf_link import CrsfLink
from matchset.links.link import Link
from matchset.links.mavlink.mavlink_link import MavlinkLink
from matchset.links.tello.tello_link import TelloLink
from matchset.sim.clips.ball_flight_clip import BallFlightClip
from radio_modules import Module
from served_neighbor import AHEAD, CAMERA, UP, ServedNeighbor

Image = npt.NDArray[np.uint8]
PERIOD = 1.0 / 30.0
GLIDE = 12  # pictures from the set place to where the vehicle is moved
SHORT = PreflightParameters(watch=0.5, settle=1.5, rest=0.7, move_time=2.0, stick_time=0.1, busy=1000.0)
"""Short times; how long computing takes is that of the computer of the tests."""
PLACES = {  # of the ball before the camera, when the vehicle has been moved by hand: m, and rad that it is turned left
    "left": (0.3, -UP, AHEAD, 0.0),
    "back": (0.0, -UP, AHEAD + 0.3, 0.0),
    "lower": (0.0, -UP - 0.2, AHEAD, 0.0),
    "turn": (0.0, -UP, AHEAD, math.radians(18.0)),
}


def filmed(name: str) -> list[Image]:
    """Pictures while the vehicle is moved from its set place."""
    x, y, z, turned = PLACES[name]
    end = np.array([x, y, z])

    def share(time: float) -> float:
        return min(time / PERIOD / GLIDE, 1.0)

    def place(time: float) -> npt.NDArray[np.float64]:
        at = np.array([0.0, -UP, AHEAD]) * (1.0 - share(time)) + end * share(time)
        return np.asarray(Rotation.from_euler("y", turned * share(time)).apply(at), np.float64)

    def turn(time: float) -> Rotation:
        return Rotation.from_euler("y", math.pi + turned * share(time))

    clip = BallFlightClip(camera=CAMERA, place=place, turn=turn, frames=GLIDE + 1, preset="clean")
    return [frame.image for frame in clip]


def ball_from_behind() -> Image:
    """The ball at the set place, its marker on the other side."""
    clip = BallFlightClip(
        camera=CAMERA,
        place=lambda _: np.array([0.0, -UP, AHEAD]),
        turn=lambda _: Rotation.identity(),
        frames=1,
        preset="clean",
    )
    return next(iter(clip)).image


@dataclass
class PlayedCamera:
    """A camera that delivers a picture every 33 ms of the test's clock, with noise of its own.

    Attributes
    ----------
    change : callable
        What is done to a picture, by its number: a fault of the exposure, the way in, or the ball.
    frozen, dead, opens : bool
        The same picture comes again and again; none comes any more; it can be opened.
    late, slow : float
        How old pictures are when they come, s; how many periods pass from one to the next.
    """

    films: dict[str, list[Image]]
    clock: Clock
    sleep: Callable[[float], None]
    model: Any = CAMERA
    change: Callable[[Image, int], Image] = lambda image, _: image
    frozen: bool = False
    dead: bool = False
    late: float = 0.02
    slow: Callable[[int], float] = lambda _: 1.0
    film: str = "left"
    shown: int = 0
    number: int = 0
    closed: bool = False
    stamped: bool = True

    def __post_init__(self) -> None:
        self._noise, self._toward, self._next = np.random.default_rng(2), 0, self.film
        self._last: Image | None = None
        self.video = self

    @property
    def fault(self) -> str:
        return "camera 0 has delivered no picture for 2.0 s" if self.dead else ""

    def now(self) -> float:
        return self.clock()

    def go(self, film: str) -> None:
        """Move the vehicle there; back to its set place first."""
        self._toward, self._next = -1, film

    def read(self) -> Frame | None:
        self.number += 1
        self.sleep(PERIOD * self.slow(self.number))
        if self.dead:
            return None
        self._move()
        image = self.films[self.film][max(self.shown, 0)]
        image = self.change(image, self.number)
        noise = self._noise.integers(-2, 3, image.shape, np.int16)
        if self._last is not None and self.frozen:
            return Frame(self._last.copy(), self.clock() - self.late, self.number)
        self._last = np.asarray(np.clip(image + noise, 0, 255), np.uint8)
        return Frame(self._last.copy(), self.clock() - self.late, self.number)

    def close(self) -> None:
        self.closed = True

    def _move(self) -> None:
        if self._toward < 0:
            self.shown -= 1
            if self.shown <= -GLIDE:  # it has rested at its set place for a while
                self.film, self._toward = self._next, 1
            return
        self.shown = min(max(self.shown, 0) + self._toward, GLIDE)


@dataclass
class Somebody:
    """A person who does as told, and answers as the test says.

    Attributes
    ----------
    answers : list of bool
        In turn; then yes.
    moves : bool
        Whether the vehicle is moved at all.
    """

    camera: PlayedCamera
    attends: bool = True
    answers: list[bool] = field(default_factory=list)
    moves: bool = True
    heard: list[str] = field(default_factory=list)

    def say(self, words: str) -> None:
        self.heard.append(words)
        film = next((film for film, move in zip(PLACES, MOVES, strict=True) if move.words in words), None)
        if film is not None and self.moves:
            self.camera.go(film)

    def confirm(self, question: str) -> bool | None:
        self.heard.append(question)
        if not self.attends:
            return None
        return self.answers.pop(0) if self.answers else True


@dataclass
class Devices:
    """Everything that a preflight needs, and what it did with it.

    Attributes
    ----------
    kind : str
        "serial", "crsf", "mavlink" or "tello".
    link_error, camera_error : Exception or None
        Raised when one is opened.
    """

    films: dict[str, list[Image]]
    files: list[str]
    kind: str = "serial"
    parameters: PreflightParameters = SHORT
    link_error: Exception | None = None
    camera_error: Exception | None = None
    flight: str | None = None

    def __post_init__(self) -> None:
        self.clock = Clock()
        self.port, self.autopilot, self.module = FakePort(self.clock), FakeAutopilot(self.clock), Module()
        self.tello = FakeTello(self.clock)
        self.camera = PlayedCamera(self.films, self.clock, self.sleep)
        self.person = Somebody(self.camera)
        self.link: Link | None = None

    def sleep(self, seconds: float) -> None:
        for _ in range(max(round(seconds / 0.001), 1) if self.kind == "crsf" else 1):
            self.clock.sleep(0.001 if self.kind == "crsf" else seconds)
            self.module.now = self.clock()
            self.module.pass_time()
            if isinstance(self.link, CrsfLink):
                self.link.module.turn()

    def open_link(self, uri: str) -> Link:
        if self.link_error is not None:
            raise self.link_error
        self.sleep(0.2)
        if self.kind == "serial":
            self.link = ArduinoLink(uri, self.port, clock=self.clock, sleep=self.sleep)
        elif self.kind == "crsf":
            self.module.read()
            self.link = CrsfLink(uri, self.module, self.clock, self._turned, threaded=False)
        elif self.kind == "tello":
            self.link = TelloLink(uri, self.tello, clock=self.clock, sleep=self.sleep)
        else:
            self.link = MavlinkLink(uri, self.autopilot, clock=self.clock, sleep=self.sleep)
        return self.link

    def _turned(self, seconds: float) -> None:
        self.sleep(seconds)

    def open_camera(self, *_: object) -> PlayedCamera:
        if self.camera_error is not None:
            raise self.camera_error
        return self.camera

    @property
    def options(self) -> PreflightOptions:
        uris = {"serial": "serial:///dev/x", "crsf": "crsf:///dev/x", "mavlink": "mavlink:udpin:0.0.0.0:1"}
        uri = uris.get(self.kind, "tello:")
        names = dict(zip(self.files[::2], self.files[1::2], strict=True))
        linked = LinkedOptions(
            camera="0",
            link=uri,
            camera_file=Path(names["--camera-file"]),
            color=[Path(names["--color"])],
            marker_color=[Path(names["--marker-color"])],
        )
        return PreflightOptions(linked=linked, report=Path("preflight.json"), force=True)

    @property
    def bench(self) -> Bench:
        return Bench(
            parameters=self.parameters,
            person=self.person,
            open_camera=self.open_camera,  # type: ignore[arg-type]
            open_link=self.open_link,
            clock=self.clock,
            sleep=self.sleep,
        )

    @property
    def motors_turned(self) -> bool:
        """Whether an arm switch was ever high, a throttle above zero, or arming asked for."""
        arduino = any(values[4] > 500 or values[2] > 172 for values in self.port.heard)
        whoop = any(values[4] > 500 or values[2] > 172 for _, values in self.module.heard)
        autopilot = any(z > 0 for _, _, z, _ in self.autopilot.sticks) or any(
            number == 400 for number, _ in self.autopilot.asked
        )
        tello = self.tello.motors or "takeoff" in self.tello.heard
        return arduino or whoop or autopilot or tello


def films() -> dict[str, list[Image]]:
    """Render all moves."""
    return {name: filmed(name) for name in PLACES}


def files_in(folder: Path) -> list[str]:
    """Write camera file and colors."""
    options: list[str] = ServedNeighbor().write_files(folder)
    return options


GONE = LinkError("cannot open /dev/x: No such file or directory")

"""The messages of a recording, in msgpack; `encoding.py` makes and reads them. Names and fields are the format.

Pictures and results are messages of ROS 2 beside them: `ros_messages.py`.
"""

from typing import Any

import msgspec

from matchset.camera.camera_model import CameraModel
from matchset.control.command import Command
from matchset.flight.chain.chain_step import Crash, FlightKind
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.image.frame import Rows

FORMAT = 4  # format: version of a recording
OLDER_NAMES = 3  # format: before keys became the names of parameters: `control.files.older_keys`
WITHOUT_GAINS = 2  # format: before gains were lowered; these three are read, any other one is refused

Triple = tuple[float, float, float]
Matrix = tuple[Triple, Triple, Triple]


class ColorsMessage(msgspec.Struct, frozen=True):
    """Color models of the ball, with its marker, and of the marker: log-odds, float32, in the order of their tables.

    Parameters
    ----------
    ball, marker : bytes
    """

    ball: bytes
    marker: bytes


class Configuration(msgspec.Struct, frozen=True, kw_only=True):
    """The first message: what does not change during the flight. Topic ``/configuration``.

    Parameters
    ----------
    format : int
    matchset : str
        Version of the package that wrote it.
    parameters : FlightParameters
    cameras : tuple of CameraModel
        One per follower.
    kind : FlightKind
    colors : tuple of ColorsMessage
        What each follower looks for; empty: what it learns from its sample.
    countdown, fps, devices
        As in `FlightSetup`.
    """

    format: int
    matchset: str
    parameters: FlightParameters
    cameras: tuple[CameraModel, ...]
    kind: FlightKind = "simulated"
    colors: tuple[ColorsMessage, ...] = ()
    countdown: float = 0.0
    fps: float = 30.0
    devices: tuple[str, ...] = ()


class Picture(msgspec.Struct, frozen=True):
    """A picture without loss. Topic ``/follower_1/sample``.

    Parameters
    ----------
    index : int
    time : float
        s.
    png : bytes
    """

    index: int
    time: float
    png: bytes


class StepMessage(msgspec.Struct, frozen=True, kw_only=True):
    """A step of a follower's loop. Topic ``/follower_1/step``.

    Parameters
    ----------
    chain_step : int
    armed : bool
        Whether the pilot was told to fly.
    frame : int or None
        Index of the picture; None if none came.
    taken : float or None
        When it was taken, s, to the last bit; the picture itself is in ``/follower_1/image/compressed``.
    now : float
        When the command was sent, s.
    command : Command
        What was sent, as the link confirmed it.
    spent : tuple of float
        Computing time of each stage, s; this alone differs from run to run.
    outcome : Raw
        `Outcome`: everything else, as the bytes that a replay must reproduce.
    stopped : str
        Why the motors were stopped in this step from outside, `PilotStep.stopped`; empty if they were not.
    landing : str
        Why it was told to land, `PilotStep.landing`; empty if it was not.
    rows : str
        Which rows of the picture are of its time, `Frame.rows`; the rest of a half-frame is of the field before.
    """

    tick: int
    armed: bool
    frame: int | None
    taken: float | None
    now: float
    command: Command
    spent: tuple[float, ...]
    outcome: msgspec.Raw
    stopped: str = ""
    landing: str = ""
    rows: Rows = "all"


class Outcome(msgspec.Struct, frozen=True, kw_only=True):
    """What a step makes of the picture, the clock and the steps before, and a replay must reproduce: of `PilotStep`.

    Up to format 3 `control` was called ``answer``, `safety` ``memory``, and the rotation of a pose ``turn``. In format
    2 the first lacks its last fields, `gains` and `doubt`.
    """

    ball: Any
    markers: Any
    pose: Any
    control: Any
    safety: Any
    command: Command
    age: float


class SightMessage(msgspec.Struct, frozen=True):
    """A vehicle: its center of mass and its ball in the room, m, and the rotation from its body to the room."""

    place: Triple
    turn: Matrix
    ball: Triple


class TruthMessage(msgspec.Struct, frozen=True, kw_only=True):
    """The simulator's truth at a step of the chain, its last message. Topic ``/truth``.

    Parameters
    ----------
    index : int
    time : float
        s.
    truth, shown : tuple of SightMessage
        Every vehicle at `time` and at the middle of the exposure.
    places : tuple
        True side, height and heading of each follower, m.
    inside : tuple of bool
    crashes : tuple of Crash
    """

    index: int
    time: float
    truth: tuple[SightMessage, ...]
    shown: tuple[SightMessage, ...]
    places: tuple[Triple, ...]
    inside: tuple[bool, ...]
    crashes: tuple[Crash, ...]


CONFIGURATION, TRUTH = "/configuration", "/truth"


def namespace(number: int) -> str:
    """Return what the names of a follower's topics begin with, from 1; ROS 2 allows no name with a digit first."""
    return f"/follower_{number}"


def sample_topic(number: int) -> str:
    """Topic of the picture from which a follower learned its colors."""
    return f"{namespace(number)}/sample"


def image_topic(number: int) -> str:
    """Topic of a follower's pictures, messages of ROS 2; without its last part, what ROS calls the camera's topic."""
    return f"{namespace(number)}/image/compressed"


def step_topic(number: int) -> str:
    """Topic of a follower's steps."""
    return f"{namespace(number)}/step"


def topics(followers: int) -> dict[str, type[msgspec.Struct]]:
    """Topics in msgpack of a recording with so many followers, and what their messages are."""
    found: dict[str, type[msgspec.Struct]] = {CONFIGURATION: Configuration, TRUTH: TruthMessage}
    for number in range(1, followers + 1):
        found |= {sample_topic(number): Picture, step_topic(number): StepMessage}
    return found

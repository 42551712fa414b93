"""What a flight is made of: `ChainStep`, one after the other; what is fixed: `FlightSetup`."""

from typing import Literal, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.flight.chain.flight_parameters import FlightParameters
from matchset.flight.chain.pilot import PilotStep
from matchset.image.frame import Frame
from matchset.links.simulation_parameters import FPS
from matchset.localization.markers.ball_colors import BallColors
from matchset.sim.vehicle import VehiclePose

Floats = npt.NDArray[np.float64]


class Crash(msgspec.Struct, frozen=True):
    """The end of a vehicle.

    Parameters
    ----------
    time : float
        s.
    vehicle : int
        Which, from 1.
    what : str
        What happened, in words: "hit the floor".
    """

    time: float
    vehicle: int
    what: str

    @property
    def description(self) -> str:
        """Who, what and when: ``vehicle 1 hit the floor at 3.2 s``."""
        return f"vehicle {self.vehicle} {self.what} at {self.time:.1f} s"


class ChainStep(msgspec.Struct, frozen=True, kw_only=True):
    """One step of every follower's loop, and the truth, which the simulator alone knows: one picture of every camera.

    Vehicles are counted as in the paper, the first follower first; `steps` has one entry per follower, the truth one
    per vehicle, so ``truth[-1]`` hangs on the rope and ``steps[i]`` watches ``truth[i + 1]``.

    Parameters
    ----------
    index : int
        Of the pictures, from 1.
    time : float
        When the commands were sent, s on the clock of the pictures.
    steps : tuple of PilotStep
        What each follower measured, decided and sent.
    truth : tuple of VehiclePose
        True pose of every vehicle, and position of its ball, at `time`, in the room: x right, y down, z forward, m.
        Empty where nobody knows.
    truth_at_exposure : tuple of VehiclePose
        The same at the middle of the pictures' exposure: what `steps` should have measured.
    true_positions : ndarray of shape (followers, 3)
        True side, height and heading of each follower's camera in the level frame of its neighbor's ball, at `time`, m
        (Epstein & Feldman, Eq. 6-8). NaN where nobody knows.
    in_view : tuple of bool
        Whether the middle of the neighbor's ball was inside each camera's picture, and nothing hid it on purpose. Where
        nobody knows: whether a picture came.
    crashes : tuple of Crash
        Of this flight so far.
    """

    index: int
    time: float
    steps: tuple[PilotStep, ...]
    truth: tuple[VehiclePose, ...]
    truth_at_exposure: tuple[VehiclePose, ...]
    true_positions: Floats
    in_view: tuple[bool, ...]
    crashes: tuple[Crash, ...]

    @property
    def down(self) -> bool:
        """Whether everyone's motors have stopped for good; who was told to land before it flew never will."""
        return all(
            step.safety.phase == "cut" or (step.safety.phase == "locked" and step.landing) for step in self.steps
        )


FlightKind = Literal["simulated", "flight", "dry run"]
"""What flew: a simulated chain; real vehicles; real ones that were sent no throttle."""


class FlightSetup(NamedTuple):
    """What does not change during a flight, one that is flown or one that is replayed.

    Attributes
    ----------
    parameters : FlightParameters
    cameras : tuple of CameraModel
        One per follower.
    samples : tuple of Frame
        A picture of each camera from before the flight.
    kind : FlightKind
    colors : tuple of BallColors
        What each follower looks for; empty: what it learns from its sample.
    countdown : float
        When the first follower is armed, s.
    fps : float
        Pictures a second of the slowest camera, about.
    devices : tuple of str
        Camera and link of each follower, for people; empty where they are simulated.
    """

    parameters: FlightParameters
    cameras: tuple[CameraModel, ...]
    samples: tuple[Frame, ...]
    kind: FlightKind = "simulated"
    colors: tuple[BallColors, ...] = ()
    countdown: float = 0.0
    fps: float = FPS
    devices: tuple[str, ...] = ()

    @property
    def followers(self) -> int:
        """Number of followers: all vehicles but the last."""
        return len(self.cameras)

    @property
    def radius(self) -> float:
        """Radius of the balls, m."""
        return self.parameters.pilot.target.radius

    @property
    def has_truth(self) -> bool:
        """Whether the simulator knows where everybody is."""
        return self.kind == "simulated"

"""One episode: `FollowFlight`, a world of two vehicles in which pictures and sticks take turns; without Gymnasium."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.control.command import Command
from matchset.flight.gym.follow_parameters import FollowParameters
from matchset.image.frame import Frame
from matchset.links.simulation_parameters import FPS, STEPS_PER_FRAME
from matchset.sim.cameras import FIELD, WorldCameras
from matchset.sim.world import RATE, World, WorldParameters, camera_position

Floats = npt.NDArray[np.float64]


class FollowFlight:
    """A follower and its neighbor, who swings on a rope, from the first picture on.

    A hand holds the follower with its motors running until the first sticks are sent, and lets go then, whatever they
    are: nobody can stay in the hand.

    Parameters
    ----------
    parameters : FollowParameters
    seed : int
        Of the world: room, swing, level, battery, noise of the pictures.

    Attributes
    ----------
    world : World
    index : int
        Of the newest picture, from 1.
    """

    def __init__(self, parameters: FollowParameters, seed: int) -> None:
        simulation = parameters.world(seed)
        held = WorldParameters(release=math.inf)
        chain = msgspec.structs.replace(simulation.chain(parameters.place), world=held)
        self.world, self.index = World(chain, seed), 1
        self._cameras = WorldCameras(self.world, simulation.camera, parameters.pal)
        self._latency = max(round(1e-3 * parameters.latency_ms * RATE), FIELD)
        place = parameters.place
        self._place = np.array((place.side, place.height, place.heading))
        self.world.send(0, Command(throttle=chain.vehicle.hover_throttle))
        self.world.advance(self._taken + self._latency)

    @property
    def time(self) -> float:
        """Since the beginning of the world, s."""
        return self.world.time

    @property
    def steps(self) -> int:
        """Number of sticks sent so far."""
        return self.index - 1

    @property
    def flown(self) -> float:
        """Since the hand let go, s."""
        return self.steps / FPS

    @property
    def crash(self) -> str:
        """What the follower hit, in words; empty if nothing."""
        return self.world.crashes[0][2] if self.world.crashes else ""

    @property
    def error(self) -> float:
        """True distance of the camera from its set place now, m."""
        return float(np.linalg.norm(self.world.place(0) - self._place))

    def step(self, command: Command) -> None:
        """Send sticks and let the time of a picture pass.

        Parameters
        ----------
        command : Command
        """
        self.world.let_go(0)
        self.world.send(0, command)
        self.index += 1
        self.world.advance(self._taken + self._latency)

    def frame(self) -> Frame:
        """Return the newest picture that has been processed: it was taken `latency_ms` ago."""
        return Frame(self._cameras.image(0, self._taken), self._taken / RATE, self.index)

    def sample(self) -> Frame:
        """Return a picture of a ball held 1 m before the camera, its marker in the middle, to learn colors from."""
        return Frame(self._cameras.held_ball(0), 0.0, 0)

    def truth(self) -> dict[str, Floats]:
        """Return what is true now, for scores and plots: nothing that the follower may see.

        Returns
        -------
        dict
            "place": side, height and heading of the camera in the level frame of the neighbor's ball, (3,), m (Epstein
            & Feldman, Eq. 6-8). "ball": the ball in the camera frame, (3,), m. "position", "rotation": of the follower
            in the room, (3,), m, and from its body to the room, (3, 3).
        """
        me, neighbor = self.world.poses(self.world.step)
        return {
            "place": self.world.place(0),
            "ball": (neighbor.ball - camera_position(me)) @ me.rotation,
            "position": me.position.copy(),
            "rotation": me.rotation.copy(),
        }

    @property
    def _taken(self) -> int:
        """Step of the middle of the newest picture's exposure."""
        return STEPS_PER_FRAME * self.index

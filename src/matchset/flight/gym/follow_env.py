"""The environment ``matchset/Follow-v0``: `FollowEnv`."""

from typing import Any

import gymnasium
import msgspec
import numpy as np
import numpy.typing as npt
from gymnasium import spaces

from matchset.app.drawing.annotate import Caption, draw_circle, write_captions
from matchset.control.command import Command
from matchset.flight.gym.follow_flight import FollowFlight
from matchset.flight.gym.follow_parameters import FollowParameters
from matchset.flight.gym.pose_sensor import HIGH, LOW, PoseSensor, pose_vector
from matchset.image.frame import Frame
from matchset.links.simulation_parameters import FPS
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost

Array = npt.NDArray[Any]

MOST_SEEDS = 2**31  # format: seeds of worlds are below


class FollowEnv(gymnasium.Env[Array, Array]):
    """Hold your place behind a neighbor's ball, by your own camera, 30 pictures a second.

    Action, Box(4): the sticks of a `Command`, roll, pitch and yaw from -1 to 1, throttle from 0 to 1; what is out of
    range is clipped. Observation, as `FollowParameters.observation` says: the camera's newest picture, Box(h, w, 3),
    uint8, BGR as `Frame.image`; or the pose measured in it, Box(8), see `pose_vector`. Both are as old as the latency.

    Reward of a step: minus the distance from the set place, m, at most `max_error`; at a crash `crash_penalty` more is
    subtracted. Terminated by a crash, truncated at the end of the duration. The info has "time" and "taken", s, of now
    and of the picture; "crash", in words; and "truth", see `FollowFlight.truth`, with "error", m. Nothing of the truth
    is in an observation.

    Parameters
    ----------
    parameters : FollowParameters, optional
    render_mode : str, optional
        "rgb_array": `render` returns the picture with a ring where the ball is at the set place.
    **changes
        Single fields of the parameters.

    Attributes
    ----------
    parameters : FollowParameters
    camera : CameraModel
        Of the pictures.
    pose : Pose or Lost
        Measured in the newest picture, where poses are observed.

    Raises
    ------
    ValueError
        If a parameter is unknown or out of range.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "render_fps": FPS}  # noqa: RUF012 - declared in Env

    def __init__(
        self, parameters: FollowParameters | None = None, render_mode: str | None = None, **changes: Any
    ) -> None:
        if render_mode not in (None, *self.metadata["render_modes"]):
            raise ValueError(f"render_mode must be rgb_array or None, got {render_mode!r}")
        try:
            self.parameters = msgspec.structs.replace(parameters or FollowParameters(), **changes)
        except TypeError as error:
            raise ValueError(f"no such parameter of FollowParameters: {error}") from None
        self.render_mode = render_mode
        self.camera = self.parameters.world(0).camera
        self.action_space = spaces.Box(np.array((-1, -1, -1, 0), np.float32), np.ones(4, np.float32))
        picture = spaces.Box(0, 255, (self.camera.height, self.camera.width, 3), np.uint8)
        self._senses_pose = self.parameters.observation == "pose"
        self.observation_space = spaces.Box(LOW, HIGH) if self._senses_pose else picture
        self.pose: Pose | Lost[Pose] = Lost("no picture yet", 0.0)
        self._flight: FollowFlight | None = None
        self._sensor: PoseSensor | None = None
        self._frame: Frame | None = None
        self._over = True

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Array, dict[str, Any]]:
        """Begin an episode: a new world; the same seed gives the same one.

        Parameters
        ----------
        seed : int, optional
            Of this and all further episodes.
        options : dict, optional
            None are known.

        Returns
        -------
        observation : ndarray
        info : dict

        Raises
        ------
        ValueError
            If there are options.
        """
        super().reset(seed=seed)
        if options:
            raise ValueError(f"there are no options of reset, got {options}")
        self._flight = FollowFlight(self.parameters, int(self.np_random.integers(MOST_SEEDS)))
        if self._senses_pose:
            self._sensor = PoseSensor(self.camera, self._flight.sample())
        self._over = False
        return self._observe(self._flight), self._info(self._flight)

    def step(self, action: Array) -> tuple[Array, float, bool, bool, dict[str, Any]]:
        """Send sticks, and wait for the next picture.

        Parameters
        ----------
        action : array_like of shape (4,)
            Roll, pitch, yaw, throttle.

        Returns
        -------
        observation : ndarray
        reward : float
        terminated, truncated : bool
        info : dict

        Raises
        ------
        ValueError
            If the action is not four finite numbers.
        gymnasium.error.ResetNeeded
            Before the first `reset`, and after the end of an episode.
        """
        flight = self._flight
        if flight is None or self._over:
            raise gymnasium.error.ResetNeeded("the episode is over or has not begun: call reset()")
        flight.step(self._command(action))
        terminated, truncated = bool(flight.crash), flight.flown >= self.parameters.duration
        self._over = terminated or truncated
        reward = -min(flight.error, self.parameters.max_error) - terminated * self.parameters.crash_penalty
        return self._observe(flight), reward, terminated, truncated, self._info(flight)

    def render(self) -> Array | None:
        """Return the newest picture with the set place of the ball and the true error, (h, w, 3), uint8, RGB."""
        if self.render_mode is None:
            gymnasium.logger.warn('render() needs render_mode="rgb_array" in gymnasium.make')
            return None
        if self._flight is None or self._frame is None:
            raise gymnasium.error.ResetNeeded("there is no picture yet: call reset()")
        picture, place = self._frame.image.copy(), self.parameters.place
        ahead = np.array((place.side, place.height, place.heading))
        x, y = self.camera.project(ahead[np.newaxis])[0].tolist()
        radius = self.camera.fx * self._flight.world.parameters.vehicle.ball_radius / place.heading
        draw_circle(picture, Circle(x, y, radius), dashed=True)
        words = self._flight.crash or f"off {100.0 * self._flight.error:.0f} cm"
        write_captions(picture, Caption(words, f"{self._flight.flown:.1f} s", bad=bool(self._flight.crash)))
        return np.ascontiguousarray(picture[:, :, ::-1])

    def sample(self) -> Frame:
        """Return a picture of a ball held 1 m before the camera, its marker in the middle, to learn colors from.

        Raises
        ------
        gymnasium.error.ResetNeeded
            Before the first `reset`.
        """
        if self._flight is None:
            raise gymnasium.error.ResetNeeded("there is no world yet: call reset()")
        return self._flight.sample()

    def _command(self, action: Array) -> Command:
        """Make sticks of an action."""
        sticks = np.asarray(action, np.float64)
        if sticks.shape != (4,) or not np.isfinite(sticks).all():
            raise ValueError(f"an action is four finite numbers, roll, pitch, yaw and throttle, got {action!r}")
        return Command(*np.clip(sticks, self.action_space.low, self.action_space.high).tolist())  # type: ignore[attr-defined]

    def _observe(self, flight: FollowFlight) -> Array:
        """Return what the follower sees: all of it comes from the picture."""
        self._frame = flight.frame()
        if self._sensor is None:
            return self._frame.image.copy()
        self.pose = self._sensor.measure(self._frame)
        return pose_vector(self.pose)

    def _info(self, flight: FollowFlight) -> dict[str, Any]:
        """Return times and truth, for people and plots."""
        taken = 0.0 if self._frame is None else self._frame.time
        truth: dict[str, Any] = {**flight.truth(), "error": flight.error}
        return {"time": flight.time, "taken": taken, "crash": flight.crash, "truth": truth}

"""Parameters of the environment: `FollowParameters`. They are the keywords of ``gymnasium.make``, too."""

from typing import Literal, get_args

import msgspec

from matchset.control.follower import RelativeSetpoint
from matchset.links.simulation_parameters import SimulationParameters
from matchset.numeric.arguments import require_within

Observation = Literal["picture", "pose"]


class FollowParameters(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The flight of a `FollowEnv`: its world, what is observed, and what is rewarded.

    Parameters
    ----------
    observation : str
        "picture", what the camera delivers; or "pose", what matchset measures in it.
    duration : float
        Length of an episode, s, after which it is truncated.
    side, height, heading : float
        The set place of the camera in the level frame of the neighbor's ball, m. Default: that of the flights,
        `PilotParameters.place`.
    start_off : float
        Offset of the start from there, m, in every axis, with signs from the seed.
    width_px, height_px : int
        Size of the picture, px. Smaller is faster to draw; the ball's radius at the set place is a twentieth of the
        width.
    fov_deg : float
        Horizontal field of view, degree.
    pal : str
        Quality of the analog video link: "clean", "typical" or "bad".
    latency_ms : float
        From the middle of a picture's exposure to its observation, ms, rounded to 1/480 s. At least 8.3 ms, when its
        second field is exposed. More is harder to fly by; the radio's delay of 30 ms is added.
    swing, yaw_deg : float
        Amplitudes of the neighbor's swing, m, and of its yaw, degree.
    bias_deg : float
        Error of the follower's level, degree, in a direction from the seed.
    max_error : float
        Largest error that is counted, m. More tells a policy that is far off in which direction the place is; less
        bounds the reward. Chosen by hand: the room ends 2 to 3 m from the set place.
    crash_penalty : float
        What a crash costs, m. Derivation: `max_error` in every one of the 900 steps of 30 s, so that no flight is
        better ended by a crash.
    """

    observation: Observation = "picture"
    duration: float = 30.0
    side: float = 0.0
    height: float = -0.19
    heading: float = 1.5
    start_off: float = 0.0
    width_px: int = 640
    height_px: int = 480
    fov_deg: float = 90.0
    pal: Literal["clean", "typical", "bad"] = "typical"
    latency_ms: float = 67.0
    swing: float = 0.1
    yaw_deg: float = 20.0
    bias_deg: float = 2.0
    max_error: float = 2.0
    crash_penalty: float = 1800.0

    def __post_init__(self) -> None:
        if self.observation not in get_args(Observation):
            raise ValueError(f"observation must be picture or pose, got {self.observation!r}")
        require_within(
            self,
            {
                "duration": (0.1, 3600.0),
                "side": (-2.0, 2.0),
                "height": (-2.0, 2.0),
                "heading": (0.5, 5.0),
                "max_error": (0.1, 100.0),
                "crash_penalty": (0.0, 1e9),
            },
        )
        _ = self.world(0)  # checks the rest

    @property
    def place(self) -> RelativeSetpoint:
        """The set place."""
        return RelativeSetpoint(side=self.side, height=self.height, heading=self.heading)

    def world(self, seed: int) -> SimulationParameters:
        """Return the parameters of a world of two vehicles.

        Parameters
        ----------
        seed : int

        Returns
        -------
        SimulationParameters
        """
        return SimulationParameters(
            vehicles=2,
            seed=seed,
            pal=self.pal,
            latency_ms=self.latency_ms,
            swing=self.swing,
            yaw_deg=self.yaw_deg,
            bias_deg=self.bias_deg,
            start_off=self.start_off,
            width=self.width_px,
            height=self.height_px,
            fov_deg=self.fov_deg,
        )

"""A rendered balloon at a follower's set place, as a camera in the network shows it: for flights of real devices."""

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.localization.markers.ball_colors import pick_marker
from matchset.sim.clips.ball_flight_clip import BallFlightClip

Image = npt.NDArray[np.uint8]

SIZE, FOV_DEG = (320, 240), 60.0
CAMERA = CameraModel.from_fov(*SIZE, math.radians(FOV_DEG))
FRAMES = 60  # then it begins again, where it began
SWAY = 0.01  # m
UP, AHEAD = 0.19, 1.5  # m, from the camera to the ball
SETTINGS = """
[flight.pilot.safety]
max_frame_age = 1.0
[flight.pilot.follower.motion_consistency]
max_evidence = 100.0
"""
"""Pictures come late beside other tests, and this camera does not answer to the sticks, which a flight knows soon."""


class ServedNeighbor:
    """Pictures for an `MjpegServer`: a balloon that sways a little, each picture with noise of its own.

    Attributes
    ----------
    hidden : bool
        Whether a wall is to be seen in its place.
    """

    def __init__(self) -> None:
        clip = BallFlightClip(camera=CAMERA, place=_place, turn=_turn, frames=FRAMES, preset="clean")
        self._frames = [frame.image for frame in clip]
        self._noise = np.random.default_rng(1)
        self.hidden = False

    def __call__(self, number: int) -> Image:
        image = self._frames[number % FRAMES]
        if self.hidden:
            image = np.full_like(image, 128)
        noise = self._noise.integers(-2, 3, image.shape, np.int16)
        return np.asarray(np.clip(image + noise, 0, 255), np.uint8)

    def write_files(self, folder: Path) -> list[str]:
        """Write the colors and the camera; returns the options of `matchset fly` that name them."""
        x, y = CAMERA.project(np.array([_place(0.0)]))[0].tolist()
        radius = 0.14 / AHEAD * CAMERA.fx
        pick_marker(self._frames[0], x, y).save(folder / "marker.npz")
        ColorModel.pick(self._frames[0], x - 0.6 * radius, y).save(folder / "ball.npz")
        CAMERA.save(folder / "camera.toml")
        return [
            *("--camera-file", str(folder / "camera.toml")),
            *("--color", str(folder / "ball.npz")),
            *("--marker-color", str(folder / "marker.npz")),
        ]


def _place(time: float) -> npt.NDArray[np.float64]:
    sway = SWAY * math.sin(2.0 * math.pi * time * 30.0 / FRAMES)
    return np.array((sway, -UP, AHEAD))


def _turn(time: float) -> Rotation:
    return Rotation.from_euler("y", 180.0, degrees=True)

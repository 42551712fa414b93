"""A rendered balloon with a marker, at known places: what the tests of `matchset locate` look at."""

import math

import cv2
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from matchset.camera.camera_model import CameraModel
from matchset.sim.clips.ball_flight_clip import BallFlightClip

SIZE = 320, 240
FOV_DEG = 60.0
CAMERA = CameraModel.from_fov(*SIZE, math.radians(FOV_DEG))
FRAMES = 20
BLUE, PURPLE = "160,142", "160,120"  # pixels of frame 0


def place(time: float) -> npt.NDArray[np.float64]:
    """Drift to the right, m."""
    return np.array((0.25 * time, 0.1 * time, 1.0))


def turn(time: float) -> Rotation:
    """Face the camera and turn slowly."""
    return Rotation.from_euler("y", 180.0 + 30.0 * time, degrees=True)


def flight(markers: tuple[tuple[float, float, float], ...] = ((0.0, 0.0, 1.0),)) -> BallFlightClip:
    """The balloon, sharp and with little noise."""
    return BallFlightClip(camera=CAMERA, place=place, turn=turn, markers=markers, frames=FRAMES, preset="clean")


def write_video(path: str, flown: BallFlightClip) -> None:
    """Write a flight as it is, without loss."""
    writer = cv2.VideoWriter(path, cv2.VideoWriter.fourcc(*"FFV1"), 30.0, SIZE)
    for frame in flown:
        writer.write(frame.image)
    writer.release()

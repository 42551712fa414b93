"""Estimate the rotation of a rendered balloon with three markers, and the camera's position in its frame."""

import math

import numpy as np
from scipy.spatial.transform import Rotation

import matchset as ms
from matchset.sim.clips.ball_flight_clip import BallFlightClip

camera = ms.CameraModel.from_fov(480, 360, math.radians(60))
position = np.array((0.2, 0.1, 1.1))
# One in front, and two that are 50° around to either side and 12° up; y is down.
around, up = np.radians((0, 50, -50)), np.radians((0, 12, 12))
directions = np.column_stack((np.sin(around) * np.cos(up), -np.sin(up), np.cos(around) * np.cos(up)))
target = ms.BallTarget(0.28, tuple((x, y, z) for x, y, z in directions.tolist()), marker_diameter=0.06)


def turn(time: float) -> Rotation:
    """Return the true rotation: facing the camera (180 degrees about y), then a slow pitch and yaw."""
    return Rotation.from_euler("yx", (180.0 + 40.0 * time, 20.0 * time), degrees=True)


flight = BallFlightClip(camera=camera, place=lambda _: position, turn=turn, markers=target.markers, frames=15)
blue, purple = camera.project(np.add(position, ((0.0, 0.07, -0.11), (0.0, 0.0, -0.14))))
tracker: ms.Tracker[ms.Circle] | None = None
for frame in flight:
    if tracker is None:
        marker_color = ms.ColorModel.pick(frame.image, *purple)
        both = ms.ColorModel.pick(frame.image, *blue) | marker_color  # the paper's filter a; purple alone is b
        tracker = ms.Tracker(ms.Circle, both, start=(blue[0], blue[1]))
        markers, localizer = ms.MarkerTracker(marker_color, target), ms.Localizer(camera, target)
    ball = tracker.update(frame)
    pose = localizer.update(ball, markers.update(frame, ball))
    if isinstance(pose, ms.Pose) and pose.rotation is not None:
        off_deg = math.degrees((turn(frame.time) * pose.rotation.inv()).magnitude())
        seen = f"side {pose.side:+.3f}  height {pose.height:+.3f}  heading {pose.heading:+.3f} m"
        print(f"{frame.index:3d}  {pose.observed}: {seen}  rotation off by {off_deg:.2f}°")

"""Locate a rendered balloon in meters, and compare with the truth: no camera and no file needed."""

import math

import numpy as np

import matchset as ms
from matchset.sim.clips.ball_flight_clip import BallFlightClip

camera = ms.CameraModel.from_fov(480, 360, math.radians(80))  # or ms.CameraModel.load("camera.toml")
localizer = ms.Localizer(camera, ms.BallTarget(diameter=0.28))


def place(time: float) -> np.ndarray:
    """Return the true position: it moves to the right, far off the camera's axis, m."""
    return np.array((0.6 + 0.9 * time, 0.1, 1.3))


click = camera.project([np.add(place(0.0), (0.07, 0.0, -0.12))])[0]  # beside the marker
tracker: ms.Tracker[ms.Circle] | None = None
for frame in BallFlightClip(camera=camera, place=place, frames=20, preset="typical"):
    if tracker is None:
        tracker = ms.Tracker(ms.Circle, ms.ColorModel.pick(frame.image, *click), start=(click[0], click[1]))
    pose = localizer.update(tracker.update(frame))
    if isinstance(pose, ms.Lost):
        print(frame.index, "lost:", pose.reason)
        continue
    x, y, z = pose.position
    sigma = np.sqrt(np.diag(pose.covariance)[:3])
    away_mm = 1000.0 * np.linalg.norm(pose.position - place(frame.time))
    print(
        f"{frame.index:3d}  x {x:+.3f} ± {sigma[0]:.3f}  y {y:+.3f} ± {sigma[1]:.3f}  z {z:.3f} ± {sigma[2]:.3f} m  "
        f"distance {pose.distance:.3f} m  error {away_mm:.1f} mm"
    )

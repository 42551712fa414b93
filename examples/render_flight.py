"""Render a flying balloon with a marker, and its camera: flight.avi, camera.toml, and the truth in m, flight.csv."""

import csv
import math
from pathlib import Path

import cv2
import numpy as np
from scipy.spatial.transform import Rotation

import matchset as ms
from matchset.sim.clips.ball_flight_clip import BallFlightClip

camera = ms.CameraModel(width=480, height=360, fx=340, fy=340, cx=239.5, cy=179.5, distortion=(-0.2, 0, 0, 0, 0))


def place(time: float) -> np.ndarray:
    """Return the true position: a loop before the camera, m."""
    return np.array((0.45 * math.sin(2.0 * time), 0.12 * math.sin(3.0 * time), 1.4 + 0.4 * math.cos(2.0 * time)))


def turn(time: float) -> Rotation:
    """Return the true rotation: facing the camera (180 degrees about y), then 30 degrees to both sides."""
    return Rotation.from_euler("y", 180.0 + 30.0 * math.sin(2.5 * time), degrees=True)


if taken := [name for name in ("flight.avi", "flight.csv", "camera.toml") if Path(name).exists()]:
    raise SystemExit(f"error: {taken[0]} exists and is not overwritten: go to another folder, or delete it")
camera.save("camera.toml")
video = cv2.VideoWriter("flight.avi", cv2.VideoWriter.fourcc(*"FFV1"), 30.0, (camera.width, camera.height))
with Path("flight.csv").open("w", newline="") as file:
    table = csv.writer(file, lineterminator="\n")
    table.writerow(("frame", "time", "x", "y", "z"))
    for frame in BallFlightClip(camera=camera, place=place, turn=turn, frames=30):
        video.write(frame.image)
        table.writerow((frame.index, round(frame.time, 6), *np.round(place(frame.time), 6)))
video.release()
print("written: flight.avi, flight.csv, camera.toml. Now type:")
print("  matchset locate flight.avi --camera camera.toml --diameter 0.28 --pick 239,200 --marker-pick 239,179")

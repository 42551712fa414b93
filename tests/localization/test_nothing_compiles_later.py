"""What calls kernels compiles them in its constructor: however the first frames look, no update waits for that."""

import functools
import os
import subprocess
import sys

import pytest

PROGRAM = """
import gc
import os

import numpy as np
from numba.core.dispatcher import Dispatcher

import matchset as ms

ROWS, COLUMNS = np.indices((240, 320))
PURPLE = ms.ColorModel.hsv((135, 80, 40), (165, 255, 255))
BLUE = ms.ColorModel.hsv((95, 120, 20), (119, 255, 255))
UNCERTAIN = tuple(tuple(row) for row in np.diag((4.0, 4.0, 2.0, 2.0, 0.01, 0.02, 5e-4, 5e-4, 0.0)).tolist())


def compiled():
    kernels = (each for each in gc.get_objects() if isinstance(each, Dispatcher))
    return {(each.py_func.__module__, each.py_func.__name__, key) for each in kernels for key in each.overloads}


def frames(centers, read_only=False):
    for index in range(6):
        image = np.full((240, 320, 3), 90, np.uint8)
        for x, y in centers:
            image[np.hypot(COLUMNS - x, ROWS - y) < 30] = (200, 60, 30)
            for side in (-9, 9):
                image[np.hypot(COLUMNS - x - side, ROWS - y) < 5] = (150, 30, 150)
        if index == 4:
            image[:] = 90
        image.flags.writeable = not read_only
        yield ms.Frame(image, index / 30, index)


def locate(camera):
    target = ms.BallTarget(markers=((0.3, 0.0, 0.9539392014169456), (-0.3, 0.0, 0.9539392014169456)))
    tracker = ms.Tracker(ms.Circle, BLUE | PURPLE)
    balls = [(frame, tracker.update(frame)) for frame in frames([(160, 120)])]
    finder, localizer, poses = ms.MarkerTracker(PURPLE, target), ms.Localizer(camera, target), ms.PoseFilter()
    before, observed = compiled(), set()
    for frame, ball in balls:
        if ball:
            for array in (ball.match_set, ball.covariance):
                array.flags.writeable = frame.index % 2 == 0
        pose = localizer.update(ball, finder.update(frame, ball))
        poses.update(pose)
        poses.predict(frame.time + 0.067)
        observed |= {pose.observed} if pose else set()
    assert "full" in observed, observed
    few = ms.Track(ms.Circle(160, 120, 30), np.eye(3), 1.0, np.empty((0, 2)), 1.0)
    assert localizer.update(few)
    return compiled() - before


def follow_all(camera):
    neighbors = ms.Neighbors(camera, ms.BallTarget(0.28, ((0.0, 0.0, 1.0),)), BLUE | PURPLE, PURPLE)
    before = compiled()
    seen = [neighbors.update(frame) for frame in frames([(80, 110), (220, 110)])]
    assert len(seen[-1]) == 2
    return compiled() - before


camera = ms.CameraModel.from_fov(320, 240, 1.07)
rough = ms.CameraModel(width=320, height=240, fx=270, fy=270, cx=160, cy=120, intrinsics_covariance=UNCERTAIN)
cases = {
    "locate(camera)": lambda: locate(camera),
    "locate(rough)": lambda: locate(rough),
    "follow_all(camera)": lambda: follow_all(camera),
}
ms.Tracker, ms.Localizer, ms.Neighbors, ms.MarkerTracker  # imported once, for all
for name, look in cases.items():
    if not os.fork():
        print(name, look(), sep=";", flush=True)
        os._exit(0)
    _, status = os.wait()
    assert status == 0
"""


@functools.cache
def late() -> dict[str, str]:
    """What was compiled late, in a fresh process for each case."""
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return dict(line.split(";") for line in done.stdout.splitlines())


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
@pytest.mark.parametrize("case", ["locate(camera)", "locate(rough)", "follow_all(camera)"])
def test_updates_compile_nothing(case: str) -> None:
    assert late()[case] == "set()"

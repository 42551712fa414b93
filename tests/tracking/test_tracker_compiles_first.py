"""A tracker compiles in its constructor, each kernel for one set of types, and nothing of a search without one."""

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

ROWS, COLUMNS = np.indices((120, 160))
HEXAGON = [(np.cos(t), np.sin(t)) for t in np.pi / 3.0 * np.arange(6)]
FAMILIES = {
    "circle": lambda: ms.Circle,
    "ellipse": lambda: ms.Ellipse,
    "rectangle": lambda: ms.Rectangle,
    "quadrilateral": lambda: ms.Quadrilateral,
    "polygon": lambda: ms.Polygon.of(HEXAGON),
}


def kernels():
    return [each for each in gc.get_objects() if isinstance(each, Dispatcher)]


def compiled():
    return {(each.py_func.__module__, each.py_func.__name__, key) for each in kernels() for key in each.overloads}


def pictures(channels):
    for index in range(12):
        image = np.full((120, 160, 3), (90, 110, 100), np.uint8)
        if index not in (5, 6, 7):
            image[(abs(COLUMNS - 70 - 3 * index) < 22) & (abs(ROWS - 60) < 17)] = (200, 60, 30)
            image[50:56, 60:66] = (20, 20, 220)
        image = image if channels == 3 else np.ascontiguousarray(image[:, :, 1])
        image.flags.writeable = index % 2 == 0
        yield ms.Frame(image, index / 30, index)


def follow(family, color, channels, **options):
    tracker = ms.Tracker(family, color, **options)
    before = compiled()
    answers = [tracker.update(frame) for frame in pictures(channels)]
    return compiled() - before, any(answers)


def look(asked, channels):
    family = FAMILIES[asked]()
    color = ms.ColorModel.hsv((100, 100, 100), (130, 255, 255)) if channels == 3 else ms.ColorModel.dark()
    late, _ = follow(family, color, channels)
    twins = [
        (each.py_func.__name__, [str(key) for key in each.overloads]) for each in kernels() if len(each.overloads) > 1
    ]
    late = sorted(str(each[:2]) for each in late)
    print(asked, channels, late, [twin for twin in twins if "user" not in twin[0]], sep=";", flush=True)


ms.Tracker, [make() for make in FAMILIES.values()]  # imported once, for all
for asked in FAMILIES:
    for channels in (3, 1):
        if not os.fork():
            look(asked, channels)
            os._exit(0)
        _, status = os.wait()
        assert status == 0
"""


@functools.cache
def seen() -> dict[tuple[str, int], list[str]]:
    """What was compiled late, and kernels of two sets of types: of each family and kind of picture, a fresh process."""
    done = subprocess.run([sys.executable, "-c", PROGRAM], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    lines = [line.split(";") for line in done.stdout.splitlines()]
    return {(asked, int(channels)): answers for asked, channels, *answers in lines}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
@pytest.mark.parametrize("channels", [3, 1])
@pytest.mark.parametrize("family", ["circle", "ellipse", "rectangle", "quadrilateral", "polygon"])
def test_no_update_of_a_tracker_compiles(family: str, channels: int) -> None:
    late, twins = seen()[family, channels]
    assert late == "[]"
    assert twins == "[]"

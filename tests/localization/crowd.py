"""Several balloons before one camera, with exact truth."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np
import numpy.typing as npt

import matchset as ms
from matchset.sim.balloon import Balloon
from matchset.sim.pal import PRESETS, degrade
from matchset.sim.renderer import draw_balloon
from matchset.sim.scene import Scene, viewpoint
from matchset.sim.shutter import fields

Floats = npt.NDArray[np.float64]
Path = Callable[[float], Sequence[float] | None]

CAMERA = ms.CameraModel.from_fov(640, 480, 1.25)
TARGET = ms.BallTarget(diameter=0.28)


def crowd(paths: Sequence[Path], frames: int, marked: Sequence[bool], seed: int, preset: str) -> Iterator[ms.Frame]:
    """Frames of balloons on their paths (camera frame, m; None while away), the nearer before the farther."""
    link = PRESETS[preset]
    background = Scene.room(seed).render(CAMERA, *viewpoint(seed))
    for index in range(frames):
        parts = []
        for _, time in fields(index, link.interlaced):
            picture = background.copy()
            there = [(path(time / 30.0), has) for path, has in zip(paths, marked, strict=True)]
            for place, has in sorted((each for each in there if each[0] is not None), key=lambda each: -each[0][2]):
                middle = np.array(place, np.float64)
                toward = tuple((-middle / np.linalg.norm(middle)).tolist())
                balloon = Balloon(marker=toward, marker_radius=0.03 if has else 0.0)
                draw_balloon(picture, CAMERA, balloon, middle[np.newaxis])
            parts.append(picture)
        for field in range(1, len(parts)):
            parts[0][field :: len(parts)] = parts[field][field :: len(parts)]
        yield ms.Frame(degrade(parts[0], link, 1000 * seed + index), index / 30.0, index)


def colors(seed: int, preset: str) -> tuple[ms.ColorModel, ms.ColorModel]:
    """The balls' color with the marker's, and the marker's alone, each learnt from one click."""
    frame = next(crowd([lambda _: (0.0, 0.0, 1.0)], 1, [True], seed, preset))
    x, y = CAMERA.cx, CAMERA.cy
    purple = ms.ColorModel.pick(frame.image, x, y)
    return ms.ColorModel.pick(frame.image, x - 40.0, y) | purple, purple


def neighbors(seed: int, preset: str) -> ms.Neighbors:
    return ms.Neighbors(CAMERA, TARGET, *colors(seed, preset))

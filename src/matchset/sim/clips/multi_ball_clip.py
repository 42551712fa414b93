"""Several balloons before one camera: `MultiBallClip`, an iterable of frames whose truth is in meters."""

from collections.abc import Callable, Iterator, Sequence

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.sim.analog_link import PRESETS, degrade
from matchset.sim.clips.balloon import Balloon
from matchset.sim.rendering.renderer import Picture, draw_balloon
from matchset.sim.rendering.shutter import fields, woven
from matchset.sim.scene.scene import Scene, viewpoint

PositionFunction = Callable[[float], Sequence[float] | None]
Array = npt.NDArray[np.float64]


class MultiBallClip(msgspec.Struct, frozen=True, kw_only=True):
    """Balloons on given paths before a camera at rest; the nearer hide the farther: `for frame in MultiBallClip(...)`.

    Parameters
    ----------
    camera : CameraModel
        It films them; without distortion.
    paths : sequence of callables
        From a time, s, to the center of each balloon in the camera frame, m, or None while it is away.
    marked : sequence of bool, optional
        Which of them carry a marker that always faces the camera; all do by default.
    frames : int
        Length.
    fps : float
        Frames per second.
    seed : int
        Decides the room and the noise.
    preset : str
        "clean", "typical" or "bad".
    """

    camera: CameraModel
    paths: Sequence[PositionFunction]
    marked: Sequence[bool] = ()
    frames: int = 100
    fps: float = 30.0
    seed: int = 0
    preset: str = "typical"

    def __iter__(self) -> Iterator[Frame]:
        link = PRESETS[self.preset]
        background = Scene.room(self.seed).render(self.camera, *viewpoint(self.seed))
        for index in range(self.frames):
            pictures = [self._draw(background, time / self.fps) for _, time in fields(index, link.interlaced)]
            yield Frame(degrade(woven(pictures), link, 1_000_003 * self.seed + index), index / self.fps, index)

    def _draw(self, background: Picture, time: float) -> Picture:
        """Draw all balloons that are there at a time, s, the farthest first."""
        picture = background.copy()
        marked = self.marked or [True] * len(self.paths)
        positions = [(path(time), has) for path, has in zip(self.paths, marked, strict=True)]
        there = [(np.array(position, np.float64), has) for position, has in positions if position is not None]
        for position, has in sorted(there, key=lambda each: -float(each[0][2])):
            x, y, z = (-position / np.linalg.norm(position)).tolist()
            balloon = Balloon(marker=(x, y, z), marker_radius=0.03 if has else 0.0)
            draw_balloon(picture, self.camera, balloon, position[np.newaxis])
        return picture

"""A balloon on a given path, its truth in meters: `BallFlightClip`, an iterable of frames."""

import functools
from collections.abc import Callable, Iterator

import msgspec
import numpy as np
import numpy.typing as npt
from scipy.spatial.transform import Rotation

from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.sim.analog_link import PRESETS, AnalogLink, degrade
from matchset.sim.clips.balloon import Balloon, Vector
from matchset.sim.rendering.lens_warp import ExactLensWarp
from matchset.sim.rendering.renderer import Picture, draw_balloon
from matchset.sim.rendering.shutter import fields, woven
from matchset.sim.scene.scene import Scene, viewpoint

Array = npt.NDArray[np.float64]


class BallFlightClip(msgspec.Struct, frozen=True, kw_only=True):
    """A balloon on a given path before a camera at rest, with lens distortion: `for frame in BallFlightClip(...)`.

    The truth of a frame is `place` (and `turn`) at its time, the middle of its exposure; `Clip` is for truth in px.

    Parameters
    ----------
    camera : CameraModel
        It films the balloon.
    place : callable
        From a time, s, to the center of the ball in the camera frame, (3,), m.
    turn : callable, optional
        From a time, s, to the `Rotation` from the ball frame to the camera frame; without it the first marker always
        faces the camera.
    markers : tuple of (float, float, float)
        Unit vectors to the markers in the ball frame.
    balloon : Balloon
        Its size and colors; its own directions of markers are ignored.
    frames : int
        Length.
    fps : float
        Frames per second.
    seed : int
        Decides noise and, without a `scene_seed`, the room.
    scene_seed : int or None
        Decides the room.
    preset : str or AnalogLink
        "clean", "typical", "bad", or a link of your own.
    """

    camera: CameraModel
    place: Callable[[float], Array]
    turn: Callable[[float], Rotation] | None = None
    markers: tuple[Vector, ...] = ((0.0, 0.0, 1.0),)
    balloon: Balloon = Balloon()
    frames: int = 300
    fps: float = 30.0
    seed: int = 0
    scene_seed: int | None = None
    preset: str | AnalogLink = "clean"

    @property
    def link(self) -> AnalogLink:
        """The analog link that `preset` names."""
        return self.preset if isinstance(self.preset, AnalogLink) else PRESETS[self.preset]

    def __len__(self) -> int:
        return self.frames

    def __iter__(self) -> Iterator[Frame]:
        view, background = _room(self.camera, self.seed if self.scene_seed is None else self.scene_seed)
        last: Picture = background
        before = np.empty(0)
        for index in range(self.frames):
            times = [time / self.fps for _, time in fields(index, self.link.interlaced)]
            poses = np.array([self._pose(time) for time in times])
            if not np.array_equal(poses, before):
                last, before = self._draw(view, background, times), poses
            image = degrade(last, self.link, self.seed * 1_000_003 + index)
            yield Frame(image, index / self.fps, index)

    def _pose(self, time: float) -> Array:
        """Numbers that decide the balloon's picture at a time: position and directions to the markers."""
        return np.concatenate((self.place(time), np.ravel(self._directions(time))))

    def _directions(self, time: float) -> list[Array]:
        """Directions to the markers in the camera frame."""
        if self.turn is None:
            return []
        return list(self.turn(time).apply(np.array(self.markers)))

    def _draw(self, view: ExactLensWarp, background: Picture, times: list[float]) -> Picture:
        """Draw a frame: one picture, or two fields."""
        pictures = []
        for time in times:
            picture = background.copy()
            balloon = self.balloon
            if self.turn is not None:
                first, *others = (tuple(each / np.linalg.norm(each)) for each in self._directions(time))
                balloon = msgspec.structs.replace(balloon, marker=first, more_markers=tuple(others))
            draw_balloon(picture, view.pinhole, balloon, self.place(time)[np.newaxis])
            pictures.append(view.warp(picture))
        return woven(pictures)


@functools.lru_cache(maxsize=2)
def _room(camera: CameraModel, seed: int) -> tuple[ExactLensWarp, Picture]:
    """Make a lens and the room behind it: flights before the same background often follow each other."""
    view = ExactLensWarp(camera)
    background = Scene.room(seed).render(view.pinhole, *viewpoint(seed))
    background.flags.writeable = False
    return view, background

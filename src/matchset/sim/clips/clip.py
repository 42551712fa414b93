"""A balloon in a room with exact truth in px: `Clip`, an iterable of (Frame, ClipTruth)."""

import math
from collections.abc import Iterator
from typing import Literal

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.numeric.arguments import require_within
from matchset.sim.analog_link import PRESETS, AnalogLink, degrade
from matchset.sim.clips.balloon import Balloon
from matchset.sim.clips.hand import HOLD, Hand, hand_at, shifted
from matchset.sim.clips.occluder import Occluder, bar_over, board_over, visible_share
from matchset.sim.clips.trajectory import BallTrajectory
from matchset.sim.clips.truth import ClipTruth, SphereOutline, mean_circle, sphere_outline
from matchset.sim.digital_camera.codec import Codec
from matchset.sim.digital_camera.digital_camera import CameraPipeline, DigitalCamera
from matchset.sim.rendering.capsules import draw_capsules
from matchset.sim.rendering.coverage import Pinhole
from matchset.sim.rendering.painted_ball import draw_painted_ball
from matchset.sim.rendering.renderer import Light, Picture, draw_occluder
from matchset.sim.rendering.shutter import ShutterRows, bands, channel_gain, fields, read_out, sub_exposures
from matchset.sim.scene.grass import grass
from matchset.sim.scene.scene import Scene, viewpoint

__all__ = ["Clip", "ClipTruth"]

# format: accepted ranges of parameters
_LIMITS = {
    "exposure": (0.0, 1.0),
    "occluder": (0.0, 0.8),
    "gain_swing": (1.0, 100.0),
    "white_balance_drift": (0.0, 1.0),
    "fps": (1e-6, 1e6),
    "speed": (0.0, 100.0),
    "seed": (0, 2**62),
    "scene_seed": (0, 2**62),
    "shrink_to": (0.5, 1e6),
    "jpeg": (1, 100),
    "hand": (0.0, 0.4),
    "blur_samples": (1, 1000),
}


class Clip(msgspec.Struct, frozen=True, kw_only=True):
    """A balloon that flies through a room before a camera at rest: `for frame, truth in Clip(...)`.

    Everything follows from the parameters: the same clip gives the same bytes.

    Parameters
    ----------
    frames : int
        Length.
    width, height : int
        Size of the picture, px.
    fps : float
        Frames per second.
    seed : int
        Decides path and noise.
    scene_seed : int or None
        Decides the room; None: `seed`.
    scene_frames : int
        A new room every so many frames; 0: one room.
    preset : str or AnalogLink or None
        "clean", "typical", "bad", a link of your own, or None: only rounded to bytes.
    exposure : float
        Share of the frame's period during which the shutter is open, 0 ... 1: motion blur. Each field of an
        interlaced frame has an exposure of its own, of this length.
    ball : bool
        False: the room without the ball.
    balloon : Balloon
        What flies.
    occluder : float
        Share of the disc that a gray stick hides, 0 (no stick) ... 0.8.
    clutter : bool
        Other blue things in the background: posters, bars, rims; never a filled disc.
    gain_swing : float
        Largest over smallest brightness; it swings in 4 s about 1. 1: steady, 2: 0.71 ... 1.41.
    white_balance_drift : float
        Share by which blue rises while red falls, and back, in 9 s. 0: steady.
    jpeg : int or None
        Quality of a JPEG step at the end, 1 ... 100.
    hand : float
        Share of the rim behind the fingers of a hand that holds the ball and moves with it, 0 ... 0.4. 0: no hand.
    light : Light
        Where light comes from, the highlight on the ball and its shadow on itself.
    backdrop : str
        "room", or "grass": a lawn, for green balls.
    blur_samples : int
        Most sub-exposures of motion blur, one per 1.5 px. More: smooth where blur is longer than 24 px; slower.
    digital : DigitalCamera
        Lens, shutter, sensor and processing of a phone or web camera, before the link of `preset`.
    codec : Codec or None
        A video encoder at a bit rate, at the very end; the whole clip goes through one encoder.
    fov : float
        Horizontal field of view, rad.
    radii : tuple of 2 floats
        Smallest and largest radius in the picture, px; equal: fixed.
    shrink_to : float or None
        The radius goes from radii[1] down to this over the clip, px.
    speed : float
        Factor on all motion: 1 is up to about 10 px per frame in x and in y, 1.85 px in r.
    away : tuple of (int, int)
        Windows [from, to) of frames in which the ball is outside the picture; it leaves and returns in the
        24 frames beside.
    hidden : tuple of (int, int)
        Windows [from, to) of frames in which a board hides the whole ball.
    """

    frames: int = 300
    width: int = 640
    height: int = 480
    fps: float = 30.0
    seed: int = 0
    scene_seed: int | None = None
    scene_frames: int = 0
    preset: str | AnalogLink | None = "typical"
    exposure: float = 0.0
    ball: bool = True
    balloon: Balloon = Balloon()
    occluder: float = 0.0
    clutter: bool = False
    gain_swing: float = 1.0
    white_balance_drift: float = 0.0
    jpeg: int | None = None
    hand: float = 0.0
    light: Light = Light()
    backdrop: Literal["room", "grass"] = "room"
    blur_samples: int = 16
    digital: DigitalCamera = DigitalCamera()
    codec: Codec | None = None
    fov: float = 1.07
    radii: tuple[float, float] = (20.0, 120.0)
    shrink_to: float | None = None
    speed: float = 1.0
    away: tuple[tuple[int, int], ...] = ()
    hidden: tuple[tuple[int, int], ...] = ()

    def __post_init__(self) -> None:
        if self.frames < 0 or self.width < 16 or self.height < 16:
            raise ValueError(f"a clip cannot have {self.frames} frames of {self.width} x {self.height} px")
        if isinstance(self.preset, str) and self.preset not in PRESETS:
            raise ValueError(f"a preset is one of {', '.join(PRESETS)}, got {self.preset!r}")
        if not 0.0 < self.radii[0] <= self.radii[1] < min(self.width, self.height) / 2.2:
            raise ValueError(f"radii must rise and fit the picture, got {self.radii} px")
        if self.backdrop not in ("room", "grass"):
            raise ValueError(f"a backdrop is room or grass, got {self.backdrop!r}")
        said = {name: limits for name, limits in _LIMITS.items() if getattr(self, name) is not None}
        require_within(self, said, "of a clip lies in")

    @classmethod
    def hard(cls, **changes: object) -> "Clip":
        """Build the hard sequence of the benchmark.

        `typical` with a stick over a fifth of the disc, other blue things, brightness swinging by a factor
        of two, half a frame of motion blur, and JPEG 40.

        Parameters
        ----------
        **changes
            Parameters of `Clip` that differ.

        Returns
        -------
        Clip
        """
        settings: dict[str, object] = {
            "preset": "typical",
            "occluder": 0.2,
            "clutter": True,
            "gain_swing": 2.0,
            "exposure": 0.5,
            "jpeg": 40,
        }
        return cls(**(settings | changes))  # type: ignore[arg-type]

    @property
    def camera(self) -> CameraModel:
        """The camera that films the clip."""
        return CameraModel.from_fov(self.width, self.height, self.fov)

    @property
    def link(self) -> AnalogLink:
        """The analog link that `preset` names."""
        if isinstance(self.preset, AnalogLink):
            return self.preset
        return AnalogLink() if self.preset is None else PRESETS[self.preset]

    @property
    def first_click(self) -> tuple[float, float]:
        """A pixel on the blue of the ball in the first frame, beside the marker: (x - r/2, y), px."""
        circle = self.truth(0).circle
        if circle is None:
            raise ValueError("the ball is not seen in the first frame: there is nothing to click at")
        return circle.x - 0.5 * circle.radius, circle.y

    def __len__(self) -> int:
        return self.frames

    def __iter__(self) -> Iterator[tuple[Frame, ClipTruth]]:
        background, room = None, -1
        pipeline = CameraPipeline(self.digital)
        coder = None if self.codec is None else self.codec.start(self.width, self.height, self.fps)
        for index in range(self.frames):
            wanted = index // self.scene_frames if self.scene_frames > 0 else 0
            if background is None or wanted != room:
                background, room = self.background(wanted), wanted
            image = self._picture(index, background, pipeline)
            yield Frame(image if coder is None else coder(image), index / self.fps, index), self.truth(index)

    def background(self, room: int = 0) -> Picture:
        """Render the room without the ball.

        Parameters
        ----------
        room : int
            Which of the clip's rooms.

        Returns
        -------
        ndarray of shape (h, w, 3), float32
            BGR, 0 ... 255.
        """
        if self.backdrop == "grass":
            return grass(self._room_seed(room), self.width, self.height)
        seed = self._room_seed(room)
        return Scene.room(seed, clutter=self.clutter).render(self.camera, *viewpoint(seed))

    def render(self, index: int, background: Picture) -> Frame:
        """Render one frame by itself: nothing of the frames before it, so no `codec` and no trail.

        Parameters
        ----------
        index : int
            Which frame.
        background : ndarray of shape (h, w, 3), float32
            The room, see `background`; unchanged.

        Returns
        -------
        Frame
            Its time is the middle of its exposure, index / fps.
        """
        return Frame(self._picture(index, background, CameraPipeline(self.digital)), index / self.fps, index)

    def _room_seed(self, room: int) -> int:
        return (self.seed if self.scene_seed is None else self.scene_seed) + 7919 * room

    def _picture(self, index: int, background: Picture, pipeline: CameraPipeline) -> npt.NDArray[np.uint8]:
        """Render one frame's picture, up to the codec."""
        picture = background.copy()
        if self.ball:
            for rows, time in fields(index, self.link.interlaced):
                self._draw_rows(picture, rows, time, index)
        seed, seconds = self.seed * 1_000_003 + index, index / self.fps
        gain = channel_gain(seconds, self.gain_swing, self.white_balance_drift)
        if self.digital.changes_pictures:
            picture, gain = pipeline(picture, seconds, gain, seed), (1.0, 1.0, 1.0)
        image = degrade(picture, self.link, seed, gain)
        if self.jpeg is not None:
            _, packed = cv2.imencode(".jpg", image, [cv2.IMWRITE_JPEG_QUALITY, self.jpeg])
            image = np.asarray(cv2.imdecode(packed, cv2.IMREAD_COLOR), dtype=np.uint8)
        return image

    def truth(self, index: int) -> ClipTruth:
        """Truth of one frame, without rendering it.

        With a rolling shutter it is that of the moment at which the row of the ball's center is exposed.

        Parameters
        ----------
        index : int
            Which frame.

        Returns
        -------
        ClipTruth
        """
        if not self.ball:
            return ClipTruth(index=index, circle=None, visible=False, share=0.0, outline=None, position=None)
        times = [self._when_read(time) for _, time in fields(index, self.link.interlaced)]
        outlines = [self._outline(time) for time in times]
        shares = [
            visible_share(o, self.camera, self._occluders(o, index), self._hand(o, time).fingers)
            for o, time in zip(outlines, times, strict=True)
        ]
        share = sum(shares) / len(shares)
        middle = self._when_read(float(index))
        x, y, z = self._path.position(middle).tolist()
        return ClipTruth(
            index=index,
            circle=mean_circle([o.circle() for o in outlines]) if share > 0.0 else None,
            visible=share > 0.0,
            share=share,
            outline=self._outline(middle),
            position=(x, y, z),
        )

    @property
    def _path(self) -> BallTrajectory:
        """The way of the ball."""
        return BallTrajectory(
            camera=self.camera,
            ball_radius=self.balloon.radius,
            radii=self.radii,
            shrink_to=self.shrink_to,
            frames=self.frames,
            step=10.0 * self.speed,
            radius_step=1.85 * self.speed,
            away=self.away,
            seed=self.seed,
        )

    def _outline(self, time: float) -> SphereOutline:
        return sphere_outline(self.camera, self._path.position(time), self.balloon.radius)

    def _occluders(self, outline: SphereOutline, index: int) -> list[Occluder]:
        if self._is_hidden(index):
            return [board_over(outline)]
        if self.occluder <= 0.0:
            return []
        angle = 1.9 + 0.35 * math.sin(0.05 * index + self.seed)
        return [bar_over(outline, self.occluder, angle)]

    def _is_hidden(self, index: int) -> bool:
        return any(begin <= index < end for begin, end in self.hidden)

    def _hand(self, outline: SphereOutline, time: float) -> Hand:
        return hand_at(outline, self.hand, time, self.seed) if self.hand > 0.0 else Hand(behind=[], fingers=[])

    def _when_read(self, time: float) -> float:
        """Time at which the row of the ball's center is exposed, frames, if the picture's middle is at `time`."""
        at = time
        if self.digital.readout > 0.0:
            for _ in range(8):
                y = min(max(self._outline(at).y, 0.0), self.height - 1.0)
                at = time + read_out(y, self.height, self.digital.readout)
        return at

    def _draw_rows(self, picture: Picture, rows: ShutterRows, time: float, index: int) -> None:
        """Draw the ball over rows of a picture: at once, or band after band as a rolling shutter exposes them."""
        readout = self.digital.readout
        if readout <= 0.0:
            self._draw_ball(picture, rows, time, index)
            return
        alone = self.occluder <= 0.0 and not self._is_hidden(index)
        for top, bottom, late in bands(self.height, readout, 10.0 * self.speed):
            outline = self._outline(time + late)
            reach = 1.5 * outline.a + 40.0 * self.speed * self.exposure + 4.0
            above, below = bottom < outline.y - reach, top > outline.y + reach
            if not (alone and (above or (below and self.hand <= 0.0))):  # nothing of the hand is above the ball
                self._draw_ball(picture[top:bottom], rows, time + late, index, top)

    def _draw_ball(self, picture: Picture, rows: ShutterRows, time: float, index: int, top: int = 0) -> None:
        """Draw the ball and what hides it, over one exposure; the picture begins with row `top`."""
        begin, end = self._outline(time - self.exposure / 2.0), self._outline(time + self.exposure / 2.0)
        smear = math.hypot(end.x - begin.x, end.y - begin.y) + abs(end.a - begin.a)
        times = sub_exposures(time, self.exposure, smear, self.blur_samples)
        outlines = [self._outline(t) for t in times]
        if not self._is_hidden(index):
            hands = [shifted(self._hand(o, t), top) for o, t in zip(outlines, times, strict=True)]
            draw_capsules(picture, [hand.behind for hand in hands], HOLD.color, rows)
            camera, positions = self.camera, np.array([self._path.position(t) for t in times])
            window = Pinhole(camera.fx, camera.fy, camera.cx, camera.cy - top)
            look = self.light, rows
            draw_painted_ball(picture, window, self.balloon, positions, self.balloon.spin * time, look)
            draw_capsules(picture, [hand.fingers for hand in hands], HOLD.color, rows)
        places = [o for outline in outlines for o in self._occluders(outline, index)]
        if places:
            draw_occluder(picture, [msgspec.structs.replace(o, y=o.y - top) for o in places], rows)

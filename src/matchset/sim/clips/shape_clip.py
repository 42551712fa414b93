"""A flat convex shape in a room with exact truth in px: `ShapeClip`, an iterable of (Frame, outline)."""

import math
from collections.abc import Iterator

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.sim.analog_link import PRESETS, degrade
from matchset.sim.clips.trajectory import BallTrajectory
from matchset.sim.rendering.coverage import draw_polygon
from matchset.sim.rendering.renderer import Picture
from matchset.sim.rendering.shutter import ShutterRows, fields, sub_exposures
from matchset.sim.scene.scene import Scene, viewpoint

Array = npt.NDArray[np.float64]


class HandParameters(msgspec.Struct, frozen=True, kw_only=True):
    """Fingers that hold a shape, and the light on it.

    Parameters
    ----------
    color : tuple of 3 floats
        Of the fingers, BGR.
    directions : tuple of floats
        From which each finger reaches in, rad. Chosen by hand: uneven, so that no two sides are hidden alike.
    tip : float
        Distance of a finger's tip from the center, in half-widths.
    shading : float
        Share by which one side of the shape is lighter than its middle.
    """

    color: tuple[float, float, float] = (120.0, 150.0, 196.0)
    directions: tuple[float, ...] = (0.0, 1.1, 2.6, 4.2)
    tip: float = 0.5
    shading: float = 0.12


HAND = HandParameters()


class ShapeClip(msgspec.Struct, frozen=True, kw_only=True):
    """A flat convex shape that moves, turns and grows before a room: `for frame, outline in ShapeClip(...)`.

    The outline is the truth, (k, 2) px, at the middle of the frame's exposure. The same clip gives the same bytes.

    Parameters
    ----------
    corners : tuple of (float, float)
        The outline upright, any unit, relative to its center, in the order in which x turns to y. A smooth outline is
        given by many corners.
    frames : int
        Length.
    width, height : int
        Size of the picture, px.
    fps : float
        Frames per second.
    seed : int
        Decides path, room and noise.
    preset : str
        "clean", "typical" or "bad": the link.
    color : tuple of 3 floats
        BGR.
    background : tuple of 3 floats or None
        One color in place of the room.
    sizes : tuple of 2 floats
        Smallest and largest radius of the circle of equal area, px.
    speed : float
        Factor on all motion: 1 is up to about 10 px per frame in x and in y, 1.85 px in size.
    spin : float
        Fastest turn in the picture, rad per frame.
    tilt : float
        Largest angle out of the picture's plane, rad: 0 keeps it parallel.
    hidden : float
        Share of the outline behind four fingers that hold it, 0 ... 0.6.
    exposure : float
        Share of the frame's period during which the shutter is open: motion blur.
    """

    corners: tuple[tuple[float, float], ...]
    frames: int = 300
    width: int = 640
    height: int = 480
    fps: float = 30.0
    seed: int = 0
    preset: str = "typical"
    color: tuple[float, float, float] = (205.0, 88.0, 30.0)
    background: tuple[float, float, float] | None = None
    sizes: tuple[float, float] = (40.0, 100.0)
    speed: float = 1.0
    spin: float = 0.03
    tilt: float = 0.0
    hidden: float = 0.0
    exposure: float = 0.0

    def __len__(self) -> int:
        return self.frames

    def __iter__(self) -> Iterator[tuple[Frame, Array]]:
        room = self.room()
        for index in range(self.frames):
            yield self.render(index, room), self.outline(float(index))

    def room(self) -> Picture:
        """Picture of the background, (h, w, 3), float32."""
        if self.background is not None:
            return np.full((self.height, self.width, 3), self.background, np.float32)
        return Scene.room(self.seed).render(self._camera, *viewpoint(self.seed))

    def render(self, index: int, room: Picture) -> Frame:
        """Render one frame before a background, (h, w, 3), float32, which stays unchanged."""
        picture, link = room.copy(), PRESETS[self.preset]
        for rows, time in fields(index, link.interlaced):
            self._draw(picture, rows, time)
        return Frame(degrade(picture, link, self.seed * 1_000_003 + index), index / self.fps, index)

    def place(self, time: float) -> tuple[float, float, float, float]:
        """Center in the picture, px, size, px, and turn, rad, at a time in frames; exact where there is no tilt."""
        x, y, reach = self._path.apparent(time)
        phase = np.random.default_rng((self.seed, 0x51DE)).uniform(0.0, 2.0 * math.pi, 3)
        turn = phase[0] + self.spin * 40.0 * math.sin(time / 40.0 + phase[1])
        return x, y, reach / self._reach, float(turn)

    @property
    def first_click(self) -> tuple[float, float]:
        """A pixel on the shape in the first frame: its middle, px."""
        x, y = self.outline(0.0).mean(axis=0).tolist()
        return x, y

    def outline(self, time: float) -> Array:
        """Exact outline at a time in frames, (k, 2), px."""
        x, y, size, turn = self.place(time)
        c, s = math.cos(turn), math.sin(turn)
        flat: Array = size * self._unit @ np.array([[c, s], [-s, c]])
        if self.tilt == 0.0:
            return np.asarray(flat + np.array([x, y]))
        phase = np.random.default_rng((self.seed, 0x7117)).uniform(0.0, 2.0 * math.pi, 2)
        lean = self.tilt * math.sin(time / 37.0 + phase[0])
        nod = self.tilt * math.sin(time / 53.0 + phase[1])
        # The plane z = 1 + tan(lean) u + tan(nod) v through the center, in units of its distance.
        camera = self._camera
        u, v = flat[:, 0] * math.cos(lean) / camera.fx, flat[:, 1] * math.cos(nod) / camera.fy
        z = 1.0 + flat[:, 0] * math.sin(lean) / camera.fx + flat[:, 1] * math.sin(nod) / camera.fy
        cx, cy = (x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy
        return np.column_stack((camera.cx + camera.fx * (cx + u) / z, camera.cy + camera.fy * (cy + v) / z))

    def fingers(self, time: float) -> list[Array]:
        """Outlines of the four fingers that hide a part of the shape, (k, 2) px each; they reach in from its rim."""
        outline = _dense(self.outline(time))
        off = outline - outline.mean(axis=0)
        found = []
        for turn in HAND.directions:
            angle = self.seed + turn + 0.3 * math.sin(0.05 * time + turn)
            along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
            ahead = off @ along > 0.0
            wide = np.sort(np.abs(off[ahead] @ across))
            half = float(wide[min(round(self.hidden / len(HAND.directions) * len(off)), len(wide) - 1)])
            tip = HAND.tip * float((off @ along).max())
            bend = np.linspace(-0.5 * math.pi, 0.5 * math.pi, 15)
            round_tip = np.column_stack((tip + half * (1.0 - np.cos(bend)), half * np.sin(bend)))
            corners = np.vstack(((900.0, -half), round_tip, (900.0, half)))[::-1]
            found.append(outline.mean(axis=0) + corners @ np.array([along, across]))
        return found

    @property
    def _unit(self) -> Array:
        """Outline of an area of pi."""
        corners: Array = np.array(self.corners, np.float64)
        corners *= math.sqrt(math.pi / cv2.contourArea(corners.astype(np.float32)))
        return corners

    @property
    def _reach(self) -> float:
        """Largest distance of the outline from its center, for an area of pi."""
        return float(np.hypot(*self._unit.T).max())

    @property
    def _camera(self) -> CameraModel:
        return CameraModel.from_fov(self.width, self.height, 1.07)

    @property
    def _path(self) -> BallTrajectory:
        reach = self._reach
        return BallTrajectory(
            camera=self._camera,
            ball_radius=1.0,
            radii=(self.sizes[0] * reach, self.sizes[1] * reach),
            step=10.0 * self.speed,
            radius_step=1.85 * self.speed,
            seed=self.seed,
        )

    def _draw(self, picture: Picture, rows: ShutterRows, time: float) -> None:
        """Draw the shape and what hides it, over one exposure."""
        begin, end = self.outline(time - 0.5 * self.exposure), self.outline(time + 0.5 * self.exposure)
        times = sub_exposures(time, self.exposure, float(np.abs(end - begin).max()))
        outlines = [self.outline(t) for t in times]
        draw_polygon(picture, outlines, self._look(outlines[len(outlines) // 2]), rows)
        if self.hidden > 0.0:
            for each in zip(*(self.fingers(t) for t in times), strict=True):
                draw_polygon(picture, list(each), HAND.color, rows)

    def _look(self, outline: Array) -> Picture:
        """Color of the shape, a little lighter on one side."""
        middle, size = outline.mean(axis=0), float(np.ptp(outline, axis=0).max())
        x, y = np.arange(self.width, dtype=np.float32), np.arange(self.height, dtype=np.float32)[:, None]
        light = 1.0 + HAND.shading * np.clip((0.6 * (x - middle[0]) - 0.8 * (y - middle[1])) / size, -1.0, 1.0)
        look: Picture = np.minimum(light[:, :, None].astype(np.float32) * np.array(self.color, np.float32), 255.0)
        return look


def _dense(outline: Array) -> Array:
    """Points at even distances along a polygon."""
    closed = np.vstack((outline, outline[:1]))
    way = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))))
    at = way[-1] * np.arange(720) / 720
    return np.column_stack((np.interp(at, way, closed[:, 0]), np.interp(at, way, closed[:, 1])))

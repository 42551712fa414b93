"""What the camera of a vehicle sees: `VehicleCamera` draws the room, the others and their balls, field by field.

A field is a picture of its own with half the lines: an interlaced sensor adds up pairs of lines. The room is drawn with
half the pixels along a line, about what an analog link lets through; vehicles and balls are drawn with all of them, in
a window around them. Then the lens bends both.
"""

import math
import threading
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.numeric.jit import kernel
from matchset.sim.clips.balloon import Balloon
from matchset.sim.rendering.background import FastScene, PackedPixels
from matchset.sim.rendering.coverage import draw_sphere_on_words
from matchset.sim.rendering.lens_warp import FastLensWarp, widen
from matchset.sim.rendering.renderer import Light, Picture, appearance
from matchset.sim.vehicle import VehiclePose

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]


class Appearance(msgspec.Struct, frozen=True):
    """What there is to see of a vehicle besides its ball.

    Parameters
    ----------
    parts : FastScene or None
        In its body frame.
    above, below : float
        How far that reaches above its ball and below its center of mass, m.
    ball : bool
        Whether it has a ball at all.
    """

    parts: FastScene | None = None
    above: float = 0.0
    below: float = 0.0
    ball: bool = True


class VehicleCamera:
    """A camera on a vehicle.

    Parameters
    ----------
    camera : CameraModel
        With its lens.
    backdrop : FastScene
        The room.
    balloon : Balloon
        What the balls look like.
    interlaced : bool
        Two fields a frame.
    """

    def __init__(self, camera: CameraModel, backdrop: FastScene, balloon: Balloon, interlaced: bool) -> None:
        self.camera, self.backdrop, self.balloon = camera, backdrop, balloon
        self._kept = threading.local()
        self.fields = 2 if interlaced else 1
        self._lenses = [FastLensWarp(camera, self.fields, k) for k in range(self.fields)]
        self._looks = appearance(balloon, Light(), np.array((0.0, 0.0, 1.0)))

    def expose(
        self, field: int, place: Floats, turn: Floats, others: list[tuple[VehiclePose, Appearance]], frame: Bytes
    ) -> None:
        """Draw one field into its lines of a frame.

        Parameters
        ----------
        field : int
            0 or 1.
        place, turn : (3,), (3, 3)
            Of the camera in the room.
        others : list of (VehiclePose, Appearance)
            Whom it may see.
        frame : ndarray of shape (h, w, 3), uint8
            BGR; lines field, field + `fields`, ... are written.
        """
        lens, back = self._lenses[field], np.ascontiguousarray(turn.T)
        shape = lens.height, lens.width // 2
        room, spread = self._buffer("room", shape, np.uint32), self._buffer("spread", shape, np.uint64)
        room[:] = 0
        self.backdrop.draw(room, lens.half, back, -back @ place, lens.columns)
        lens.bend(room, spread, frame)
        box = self._window(lens, others, place, back)
        if box is not None:
            left, top, right, bottom = box.tolist()
            patch = np.empty((bottom - top, right - left), np.uint32)
            widen(room, left, top, patch)
            self._draw(patch, lens, left, top, others, place, back)
            lens.bend_patch(patch, left, top, frame)

    def frame(self) -> Bytes:
        """Memory for a frame, of this thread: what is drawn there is valid until the next one."""
        frame: Bytes = self._buffer("frame", (self.camera.height, self.camera.width, 3), np.uint8)
        return frame

    def planes(self) -> Picture:
        """Memory for the analog link to work in, of this thread."""
        planes: Picture = self._buffer("planes", (self.camera.height, 3, self.camera.width), np.float32)
        return planes

    def _buffer(self, name: str, shape: tuple[int, ...], kind: type) -> Any:
        """Memory that each thread keeps from picture to picture: fresh pages cost more than drawing on them."""
        kept = self._kept.__dict__
        if name not in kept or kept[name].shape != shape:
            kept[name] = np.zeros(shape, kind)
        return kept[name]

    def _window(
        self, lens: FastLensWarp, others: list[tuple[VehiclePose, Appearance]], place: Floats, back: Floats
    ) -> npt.NDArray[np.int64] | None:
        """Tell which part of the pinhole's picture shows vehicles, on even columns; None if none."""
        if not others:
            return None
        box = np.empty(4, np.int64)
        places, balls = np.array([each.position for each, _ in others]), np.array([each.ball for each, _ in others])
        reaches = np.array([(look.above, look.below) for _, look in others])
        radius, size = self.balloon.radius, np.array((lens.width, lens.height))
        seen = window_of(places, balls, reaches, radius, np.array(lens.full), place, back, size, box)
        return box if seen else None

    def _draw(
        self,
        patch: PackedPixels,
        lens: FastLensWarp,
        left: int,
        top: int,
        others: list[tuple[VehiclePose, Appearance]],
        place: Floats,
        back: Floats,
    ) -> None:
        """Draw frames and balls into a window, the farthest first."""
        window = lens.full._replace(cx=lens.full.cx - left, cy=lens.full.cy - top)
        pinhole = np.array(window)
        things: list[tuple[float, VehiclePose, FastScene | None]] = []
        for sight, look in others:
            if look.parts is not None:
                things.append((math.dist(sight.position, place), sight, look.parts))
            if look.ball:
                things.append((math.dist(sight.ball, place), sight, None))
        for _, sight, parts in sorted(things, key=lambda thing: -thing[0]):
            if parts is not None:
                parts.draw(patch, window, back @ sight.rotation, back @ (sight.position - place))
            else:
                radius = self.balloon.radius
                draw_ball(patch, pinhole, place, back, sight.ball, sight.rotation, radius, self._looks)


Ints = npt.NDArray[np.int64]

REACH = 0.2  # m, radius of the sphere that a vehicle without its ball fills
MARGIN = 4  # px around a window
NEAREST = 0.12  # m, nothing nearer to the lens than that is drawn of vehicles
TALL = 0.19  # m from a vehicle's center of mass to its ball's, along which `Look.above` is measured
TOP = 0.05  # m, radius of the sphere at the upper end of what is above a ball
BESIDE = 0.05  # m, a ball must be so far before the lens to be drawn
MARKER, BETWEEN, EYE_DEPTH = 6, 16, 19  # places in `matchset.sim.rendering.renderer.appearance`
LIGHT = 10


@kernel
def window_of(
    places: Floats,
    balls: Floats,
    looks: Floats,
    radius: float,
    lens: Floats,
    place: Floats,
    back: Floats,
    size: Ints,
    box: Ints,
) -> bool:
    """Write left, top, right, bottom of the part of a picture that shows vehicles, on even columns; False if none.

    Parameters
    ----------
    places, balls : (n, 3)
        Of the vehicles, m, in the room.
    looks : (n, 2)
        How far they reach above the ball and below the center of mass, m.
    radius : float
        Of the balls, m.
    lens : (4,)
        fx, fy, cx, cy of the pinhole, px.
    place, back : (3,), (3, 3)
        Where the camera is, and the rotation from the room to it.
    size : (2,)
        Width and height of its picture, px.
    box : (4,), written
    """
    ends = np.array((math.inf, math.inf, -math.inf, -math.inf))
    center = np.empty(3)
    for k in range(places.shape[0]):
        above, below = looks[k, 0], looks[k, 1]
        _take_in(places[k], max(REACH, below), lens, place, back, ends)
        _take_in(balls[k], radius, lens, place, back, ends)
        if above > 0.0:
            for j in range(3):
                center[j] = balls[k, j] + above / TALL * (balls[k, j] - places[k, j])
            _take_in(center, TOP, lens, place, back, ends)
    if not (ends[2] >= ends[0] and ends[3] >= ends[1]):
        return False
    for j in range(2):
        low, high = min(max(ends[j], -1e6), 1e6), min(max(ends[2 + j], -1e6), 1e6)
        box[j] = max(math.floor(low) - MARGIN, 0)
        box[2 + j] = min(math.ceil(high) + MARGIN, size[j])
    box[0] -= box[0] % 2
    box[2] -= box[2] % 2
    wide, tall = box[2] - box[0] > 2, box[3] - box[1] > 2
    return bool(wide and tall)


@kernel
def _take_in(center: Floats, radius: float, lens: Floats, place: Floats, back: Floats, ends: Floats) -> None:
    """Widen the ends (left, top, right, bottom) of a window by a sphere, unless it is behind the camera."""
    away = np.empty(3)
    for j in range(3):
        away[j] = 0.0
        for i in range(3):
            away[j] += back[j, i] * (center[i] - place[i])
    z = away[2]
    if z < NEAREST:
        return
    reach = radius / max(z - radius, NEAREST)
    for j in range(2):
        at, wide = lens[2 + j] + lens[j] * (away[j] / z), lens[j] * reach * (1.0 + abs(away[j] / z))
        ends[j], ends[2 + j] = min(ends[j], at - wide), max(ends[2 + j], at + wide)


@kernel
def draw_ball(
    patch: PackedPixels,
    lens: Floats,
    place: Floats,
    back: Floats,
    ball: Floats,
    turn: Floats,
    radius: float,
    looks: Floats,
) -> None:
    """Draw a vehicle's ball, its marker backward, over a picture.

    Parameters
    ----------
    patch : (h, w), written
        Pixels as words, B in the lowest byte.
    lens : (4,)
        fx, fy, cx, cy of the pinhole, px.
    place, back : (3,), (3, 3)
        Where the camera is, and the rotation from the room to it.
    ball, turn : (3,), (3, 3)
        Center of the ball in the room, and the rotation of its vehicle to the room.
    radius : float
        m.
    looks : (20,)
        `matchset.sim.rendering.renderer.appearance` of the ball, but for what depends on where it is.
    """
    center, marker, look = np.zeros(3), np.zeros(3), looks.copy()
    for j in range(3):
        for i in range(3):
            center[j] += back[j, i] * (ball[i] - place[i])
            marker[j] -= back[j, i] * turn[i, 2]
    if center[2] < radius + BESIDE:
        return  # beside or behind the camera
    far, long = _length(center), _length(marker)
    for j in range(3):
        look[MARKER + j] = marker[j] / long
        look[BETWEEN + j] = look[LIGHT + j] - center[j] / far
    between = max(_length(look[BETWEEN : BETWEEN + 3]), 1e-9)
    for j in range(3):
        look[BETWEEN + j] /= between
    look[EYE_DEPTH] = center[2] / far
    draw_sphere_on_words(patch, lens, center, radius, look)


@kernel
def _length(v: Floats) -> float:
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])

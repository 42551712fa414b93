"""What the camera of a vehicle sees: `VehicleCamera` draws the room, the other vehicles and their balls.

It draws field by field. A field is a picture of its own with half the lines: an interlaced sensor adds up pairs of
lines. The room is drawn with half the pixels along a line, about what an analog link lets through; vehicles and balls
are drawn with all of them, in a window around them. Then both are warped by the lens.
"""

import math
import threading
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.camera.camera_model import CameraModel
from matchset.numeric.jit import kernel
from matchset.numeric.record import Block
from matchset.sim.clips.balloon import Balloon
from matchset.sim.conditions.shade import Shade
from matchset.sim.rendering.background import FastScene, packed
from matchset.sim.rendering.coverage import SHADING, PackedPixels, Pinhole, draw_sphere_fast
from matchset.sim.rendering.lens_warp import FastLensWarp, widen
from matchset.sim.rendering.renderer import Light, ball_shading
from matchset.sim.vehicle import VehiclePose

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Box = tuple[int, int, int, int]

FRAME_RADIUS = 0.2  # geometry: m, radius of the sphere that a vehicle without its ball fills
MARGIN = 4  # geometry: px around a window
NEAREST = 0.12  # geometry: m, nothing nearer to the camera than that is drawn of vehicles
BALL_HEIGHT = 0.19  # geometry: m from a center of mass to its ball's, along which `Appearance.above` is measured
TOP_RADIUS = 0.05  # geometry: m, radius of the sphere at the upper end of what is above a ball
BALL_DISTANCE = 0.05  # geometry: m, a ball must be so far before the camera to be drawn


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
    turn : (3, 3) or None
        From its ball, whose marker is at -z, to its body; None: they are not turned against each other.
    """

    parts: FastScene | None = None
    above: float = 0.0
    below: float = 0.0
    ball: bool = True
    turn: Floats | None = None


class Viewpoint(NamedTuple):
    """Where a camera is: its position in the room, (3,), m, and the rotation from the room to it, (3, 3)."""

    position: Floats
    from_room: Floats


class VisibleVehicles(NamedTuple):
    """Positions and centers of the balls of vehicles, (n, 3) each, m; how far they reach above and below, (n, 2), m."""

    positions: Floats
    balls: Floats
    extents: Floats


class VehicleCamera:
    """A camera on a vehicle.

    Its kernels are compiled in the constructor.

    Parameters
    ----------
    camera : CameraModel
        With its lens.
    room : FastScene
    balloon : Balloon
        What the balls look like.
    interlaced : bool
        Two fields a frame.
    shade : Shade, optional
        What throws shadows; nothing does by default.

    Attributes
    ----------
    fields : int
        Fields of a frame: 1 or 2.
    """

    def __init__(
        self, camera: CameraModel, room: FastScene, balloon: Balloon, interlaced: bool, shade: Shade | None = None
    ) -> None:
        self.camera, self.room, self.balloon, self.shade = camera, room, balloon, shade
        self._kept = threading.local()
        self.fields = 2 if interlaced else 1
        self._lenses = [FastLensWarp(camera, self.fields, k) for k in range(self.fields)]
        self._shading = ball_shading(balloon, Light(), np.array((0.0, 0.0, 1.0)))
        ahead = np.array((0.0, 0.0, 1.0))
        self.expose(0, np.zeros(3), np.eye(3), [(VehiclePose(ahead, np.eye(3), ahead), Appearance())], self.frame())

    def expose(
        self,
        field: int,
        position: Floats,
        rotation: Floats,
        others: list[tuple[VehiclePose, Appearance]],
        frame: Bytes,
    ) -> None:
        """Draw one field into its lines of a frame.

        Parameters
        ----------
        field : int
            0 or 1.
        position, rotation : (3,), (3, 3)
            Of the camera in the room, m.
        others : list of (VehiclePose, Appearance)
            Whom it may see.
        frame : ndarray of shape (h, w, 4), uint8
            BGR, and a byte that nobody reads; lines field, field + `fields`, ... are written.
        """
        lens, view = self._lenses[field], Viewpoint(position, np.ascontiguousarray(rotation.T))
        words, room = packed(frame), self._buffer("room", (lens.height, lens.width // 2), np.uint32)
        room[:] = 0
        nearest = self.room.draw(room, lens.half, view.from_room, -view.from_room @ position, lens.columns)
        if self.shade is not None:
            for pose, _ in others:
                spot = view.from_room @ (self.shade.below(pose.ball) - position)
                self.shade.spot.draw(room, lens.half, view.from_room, spot, lens.columns, nearest)
        lens.warp(room, words)
        left, top, right, bottom = self._window(lens, others, view)
        if right > left:
            window = np.empty((bottom - top, right - left), np.uint32)
            widen(room, left, top, window)
            self._draw(window, lens.full._replace(cx=lens.full.cx - left, cy=lens.full.cy - top), others, view)
            lens.warp_window(window, left, top, words)

    def frame(self) -> Bytes:
        """Memory for a frame, of this thread: what is drawn there is valid until the next one."""
        frame: Bytes = self._buffer("frame", (self.camera.height, self.camera.width, 4), np.uint8)
        return frame

    def _buffer(self, name: str, shape: tuple[int, ...], kind: type) -> Any:
        """Memory that each thread keeps from picture to picture: fresh pages cost more than drawing on them."""
        kept = self._kept.__dict__
        if name not in kept or kept[name].shape != shape:
            kept[name] = np.zeros(shape, kind)
        return kept[name]

    def _window(self, lens: FastLensWarp, others: list[tuple[VehiclePose, Appearance]], view: Viewpoint) -> Box:
        """Left, top, right, bottom of the part of the pinhole's picture that shows vehicles; all 0 if none."""
        if not others:
            return 0, 0, 0, 0
        vehicles = VisibleVehicles(
            np.array([pose.position for pose, _ in others]),
            np.array([pose.ball for pose, _ in others]),
            np.array([(appearance.above, appearance.below) for _, appearance in others]),
        )
        return _window_of(vehicles, self.balloon.radius, lens.full, view, (lens.width, lens.height))

    def _draw(
        self,
        window: PackedPixels,
        pinhole: Pinhole,
        others: list[tuple[VehiclePose, Appearance]],
        view: Viewpoint,
    ) -> None:
        """Draw frames and balls into a window, the farthest first."""
        things: list[tuple[float, Floats, Floats, FastScene | None]] = []
        for pose, appearance in others:
            if appearance.parts is not None:
                things.append((math.dist(pose.position, view.position), pose.position, pose.rotation, appearance.parts))
            if appearance.ball:
                turned = pose.rotation if appearance.turn is None else pose.rotation @ appearance.turn
                things.append((math.dist(pose.ball, view.position), pose.ball, turned, None))
        for _, position, rotation, parts in sorted(things, key=lambda thing: -thing[0]):
            if parts is not None:
                back = view.from_room
                parts.draw(window, pinhole, back @ rotation, back @ (position - view.position))
            else:
                shade, lit = self.shade, self._shading
                lit = lit if shade is None else shade.ball(lit, position, view.from_room)
                _draw_ball(window, pinhole, view, position, rotation, lit)


@kernel
def _window_of(vehicles: VisibleVehicles, radius: float, lens: Pinhole, view: Viewpoint, size: tuple[int, int]) -> Box:
    """Left, top, right, bottom of the part of a picture that shows vehicles, on even columns; all 0 if none.

    Parameters
    ----------
    vehicles : VisibleVehicles
    radius : float
        Of the balls, m.
    lens : Pinhole
    view : Viewpoint
    size : (int, int)
        Width and height of its picture, px.
    """
    box = np.array((math.inf, math.inf, -math.inf, -math.inf))
    positions, balls, extents = vehicles
    center = np.empty(3)
    for k in range(positions.shape[0]):
        above, below = extents[k, 0], extents[k, 1]
        _include(positions[k], max(FRAME_RADIUS, below), lens, view, box)
        _include(balls[k], radius, lens, view, box)
        if above > 0.0:
            for j in range(3):
                center[j] = balls[k, j] + above / BALL_HEIGHT * (balls[k, j] - positions[k, j])
            _include(center, TOP_RADIUS, lens, view, box)
    if not (box[2] >= box[0] and box[3] >= box[1]):
        return 0, 0, 0, 0
    left, right = _widened(box[0], box[2], size[0])
    top, bottom = _widened(box[1], box[3], size[1])
    left -= left % 2
    right -= right % 2
    return (left, top, right, bottom) if right - left > 2 and bottom - top > 2 else (0, 0, 0, 0)


@kernel(refcount=False)
def _widened(low: float, high: float, size: int) -> tuple[int, int]:
    """First pixel of a range and the one after the last, with a margin, within the picture."""
    low, high = min(max(low, -1e6), 1e6), min(max(high, -1e6), 1e6)
    return max(math.floor(low) - MARGIN, 0), min(math.ceil(high) + MARGIN, size)


@kernel
def _include(center: Floats, radius: float, lens: Pinhole, view: Viewpoint, box: Floats) -> None:
    """Widen a box (left, top, right, bottom) by a sphere, unless it is behind the camera."""
    away = np.empty(3)
    for j in range(3):
        away[j] = 0.0
        for i in range(3):
            away[j] += view.from_room[j, i] * (center[i] - view.position[i])
    z = away[2]
    if z < NEAREST:
        return
    reach = radius / max(z - radius, NEAREST)
    x, half_x = lens.cx + lens.fx * (away[0] / z), lens.fx * reach * (1.0 + abs(away[0] / z))
    y, half_y = lens.cy + lens.fy * (away[1] / z), lens.fy * reach * (1.0 + abs(away[1] / z))
    box[0], box[2] = min(box[0], x - half_x), max(box[2], x + half_x)
    box[1], box[3] = min(box[1], y - half_y), max(box[3], y + half_y)


@kernel
def _draw_ball(
    window: PackedPixels, lens: Pinhole, view: Viewpoint, ball: Floats, rotation: Floats, template: Block
) -> None:
    """Draw a vehicle's ball, its marker backward, over a picture.

    Parameters
    ----------
    window : (h, w), written
    lens : Pinhole
    view : Viewpoint
    ball, rotation : (3,), (3, 3)
        Center of the ball in the room, and the rotation of its vehicle to the room.
    template : block
        `matchset.sim.rendering.coverage.BallShading` but for what depends on where the ball is.
    """
    center, marker = np.zeros(3), np.zeros(3)
    shading = template.copy().view(SHADING)[0]
    for j in range(3):
        for i in range(3):
            center[j] += view.from_room[j, i] * (ball[i] - view.position[i])
            marker[j] -= view.from_room[j, i] * rotation[i, 2]
    if center[2] < shading.radius + BALL_DISTANCE:
        return  # beside or behind the camera
    far, long = _length(center), _length(marker)
    for j in range(3):
        shading.marker[j] = marker[j] / long
        shading.halfway[j] = shading.light[j] - center[j] / far
    between = max(_length(shading.halfway), 1e-9)
    for j in range(3):
        shading.halfway[j] /= between
    shading.facing = center[2] / far
    draw_sphere_fast(window, lens, center, shading)


@kernel(refcount=False)
def _length(v: Floats) -> float:
    return math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])

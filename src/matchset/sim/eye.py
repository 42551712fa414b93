"""What the camera of a flying vehicle sees: `Eye`, which draws the room, the others and their balls, field by field.

A field is a picture of its own with half the lines: an interlaced sensor adds up pairs of lines. The room is drawn with
half the pixels along a line, about what an analog link lets through; vehicles and balls are drawn with all of them, in
a window around them. Then the lens bends both.
"""

import math
import threading
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.localization.camera_model import CameraModel
from matchset.sim.backdrop import Backdrop, Window, as_words
from matchset.sim.balloon import Balloon
from matchset.sim.renderer import Picture, paint_balloon

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]
Box = tuple[int, int, int, int]

BACKWARD = np.array((0.0, 0.0, -1.0))  # where a vehicle's marker looks, body frame
REACH = 0.2  # m, radius of the sphere that a vehicle without its ball fills
MARGIN = 4  # px around a window
NEAREST = 0.12  # m, nothing nearer to the lens than that is drawn of vehicles


class Sight(msgspec.Struct, frozen=True):
    """A vehicle as others see it at a moment.

    Parameters
    ----------
    place : (3,)
        Its center of mass in the room, m.
    turn : (3, 3)
        From its body to the room.
    ball : (3,)
        Center of its ball in the room, m.
    """

    place: Floats
    turn: Floats
    ball: Floats


class Look(msgspec.Struct, frozen=True):
    """What there is to see of a vehicle besides its ball.

    Parameters
    ----------
    parts : Backdrop or None
        In its body frame.
    above, below : float
        How far that reaches above its ball and below its center of mass, m.
    ball : bool
        Whether it has a ball at all.
    """

    parts: Backdrop | None = None
    above: float = 0.0
    below: float = 0.0
    ball: bool = True


class Eye:
    """A camera on a vehicle.

    Parameters
    ----------
    camera : CameraModel
        With its lens.
    backdrop : Backdrop
        The room.
    balloon : Balloon
        What the balls look like.
    interlaced : bool
        Two fields a frame.
    """

    def __init__(self, camera: CameraModel, backdrop: Backdrop, balloon: Balloon, interlaced: bool) -> None:
        self.camera, self.backdrop, self.balloon = camera, backdrop, balloon
        self._kept = threading.local()
        self.fields = 2 if interlaced else 1
        self._lenses = [_FieldLens(camera, self.fields, k) for k in range(self.fields)]

    def expose(self, field: int, place: Floats, turn: Floats, others: list[tuple[Sight, Look]]) -> Bytes:
        """Draw one field.

        Parameters
        ----------
        field : int
            0 or 1.
        place, turn : (3,), (3, 3)
            Of the camera in the room.
        others : list of (Sight, Look)
            Whom it may see.

        Returns
        -------
        ndarray of shape (h / fields, w, 4), uint8
            BGRA.
        """
        lens, back = self._lenses[field], np.ascontiguousarray(turn.T)
        room = self._buffer("room", (lens.height, lens.width // 2, 4), np.uint8)
        room[:] = 0
        self.backdrop.draw(as_words(room), lens.half, back, -back @ place)
        picture = lens.bend(room)
        box = self._window(lens, others, place, back)
        if box is not None:
            left, top, right, bottom = box
            half = room[top:bottom, left // 2 : right // 2]
            patch = cv2.resize(half, (right - left, bottom - top), interpolation=cv2.INTER_LINEAR)
            self._draw(patch, lens, box, others, place, back)
            lens.bend_into(picture, patch, box)
        return picture

    def join(self, fields: list[Bytes]) -> Picture:
        """Weave fields into a frame, which is valid until the next one of this thread."""
        frame: Picture = self._buffer("frame", (self.camera.height, self.camera.width, 3), np.float32)
        for k, field in enumerate(fields):
            frame[k :: len(fields)] = cv2.cvtColor(field, cv2.COLOR_BGRA2BGR)
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

    def _window(self, lens: "_FieldLens", others: list[tuple[Sight, Look]], place: Floats, back: Floats) -> Box | None:
        """Tell which part of the pinhole's picture shows vehicles, on even columns; None if none."""
        low, high = np.full(2, np.inf), np.full(2, -np.inf)
        scale, middle = np.array((lens.full.fx, lens.full.fy)), np.array((lens.full.cx, lens.full.cy))
        for sight, look in others:
            spheres = [(sight.place, max(REACH, look.below)), (sight.ball, self.balloon.radius)]
            if look.above > 0.0:
                spheres.append((sight.ball + look.above / 0.19 * (sight.ball - sight.place), 0.05))
            for center, radius in spheres:
                x, y, z = back @ (center - place)
                if z < NEAREST:
                    continue
                reach = radius / max(z - radius, NEAREST)
                at = middle + scale * (x / z, y / z)
                low = np.minimum(low, at - scale * reach * (1.0 + abs(x / z)))
                high = np.maximum(high, at + scale * reach * (1.0 + abs(x / z)))
        if not (high >= low).all():
            return None
        left, top = (max(math.floor(value) - MARGIN, 0) for value in low)
        right, bottom = (
            min(math.ceil(value) + MARGIN, most) for value, most in zip(high, (lens.width, lens.height), strict=True)
        )
        left, right = left - left % 2, right - right % 2
        return (left, top, right, bottom) if right - left > 2 and bottom - top > 2 else None

    def _draw(
        self, patch: Bytes, lens: "_FieldLens", box: Box, others: list[tuple[Sight, Look]], place: Floats, back: Floats
    ) -> None:
        """Draw frames and balls into a window, the farthest first."""
        window = lens.full._replace(cx=lens.full.cx - box[0], cy=lens.full.cy - box[1])
        things: list[tuple[float, Sight, Look | None]] = []
        for sight, look in others:
            if look.parts is not None:
                things.append((math.dist(sight.place, place), sight, look))
            if look.ball:
                things.append((math.dist(sight.ball, place), sight, None))
        for _, sight, part in sorted(things, key=lambda thing: -thing[0]):
            if part is not None and part.parts is not None:
                part.parts.draw(as_words(patch), window, back @ sight.turn, back @ (sight.place - place))
            else:
                self._draw_ball(patch, window, sight, place, back)

    def _draw_ball(self, patch: Bytes, window: Window, sight: Sight, place: Floats, back: Floats) -> None:
        center = back @ (sight.ball - place)
        if center[2] < self.balloon.radius + 0.05:
            return  # beside or behind the camera
        marker = back @ (sight.turn @ BACKWARD)
        marker /= np.linalg.norm(marker)
        ball = msgspec.structs.replace(self.balloon, marker=(float(marker[0]), float(marker[1]), float(marker[2])))
        picture = patch[..., :3].astype(np.float32)
        paint_balloon(picture, window, ball, center[np.newaxis])
        patch[..., :3] = picture + 0.5


class _FieldLens:
    """The pinhole that draws a field, in full and with half the columns, and how its picture is bent.

    Line r of the field is line ``fields r + field`` of the frame.
    """

    def __init__(self, camera: CameraModel, fields: int, field: int) -> None:
        height = (camera.height - field + fields - 1) // fields
        rows, columns = np.indices((height, camera.width)).reshape(2, -1).astype(np.float64)
        rays = camera.rays(np.column_stack((columns, fields * rows + field)))
        slopes = [(rays[:, k] / rays[:, 2]).reshape(height, camera.width) for k in range(2)]
        fx, fy = camera.fx, camera.fy / fields
        cx = float(math.ceil(fx * np.abs(slopes[0]).max())) + 4.0
        cy = float(math.ceil(fy * np.abs(slopes[1]).max())) + 4.0
        self.width, self.height = 2 * int(cx) + 2, 2 * int(cy) + 1
        self.full = Window(fx, fy, cx, cy)
        self.half = Window(0.5 * fx, fy, 0.5 * (cx - 0.5), cy)
        x, y = fx * slopes[0] + cx, fy * slopes[1] + cy
        self._x, self._y = x.astype(np.float32), y.astype(np.float32)
        self._room = cv2.convertMaps(((x - 0.5) / 2.0).astype(np.float32), self._y, cv2.CV_16SC2)

    def bend(self, room: Bytes) -> Bytes:
        """Bend a picture with half the columns, and widen it."""
        return np.asarray(cv2.remap(room, *self._room, cv2.INTER_LINEAR), np.uint8)

    def bend_into(self, picture: Bytes, patch: Bytes, box: Box) -> None:
        """Bend a window of the full picture into a bent field."""
        inside_x = (self._x >= box[0]) & (self._x <= box[2] - 1)
        inside = inside_x & (self._y >= box[1]) & (self._y <= box[3] - 1)
        rows, columns = np.flatnonzero(inside.any(axis=1)), np.flatnonzero(inside.any(axis=0))
        if rows.size == 0:
            return
        part = (slice(int(rows[0]), int(rows[-1]) + 1), slice(int(columns[0]), int(columns[-1]) + 1))
        x, y = self._x[part] - np.float32(box[0]), self._y[part] - np.float32(box[1])
        under = np.ascontiguousarray(picture[part])
        bent = cv2.remap(patch, x, y, cv2.INTER_LINEAR, dst=under, borderMode=cv2.BORDER_TRANSPARENT)
        picture[part] = bent

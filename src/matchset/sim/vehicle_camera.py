"""What the camera of a flying vehicle sees: `Eye`, which draws the room, the others and their balls, field by field.

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
from matchset.sim.clips.balloon import Balloon
from matchset.sim.rendering.background import Backdrop, Words
from matchset.sim.rendering.field_lens import FieldLens, widen
from matchset.sim.rendering.renderer import Light, Picture, appearance
from matchset.sim.visible_objects import draw_ball, window_of

Floats = npt.NDArray[np.float64]
Bytes = npt.NDArray[np.uint8]

BACKWARD = np.array((0.0, 0.0, -1.0))  # where a vehicle's marker looks, body frame


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
        self._lenses = [FieldLens(camera, self.fields, k) for k in range(self.fields)]
        self._looks = appearance(balloon, Light(), np.array((0.0, 0.0, 1.0)))

    def expose(self, field: int, place: Floats, turn: Floats, others: list[tuple[Sight, Look]], frame: Bytes) -> None:
        """Draw one field into its lines of a frame.

        Parameters
        ----------
        field : int
            0 or 1.
        place, turn : (3,), (3, 3)
            Of the camera in the room.
        others : list of (Sight, Look)
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
        self, lens: FieldLens, others: list[tuple[Sight, Look]], place: Floats, back: Floats
    ) -> npt.NDArray[np.int64] | None:
        """Tell which part of the pinhole's picture shows vehicles, on even columns; None if none."""
        if not others:
            return None
        box = np.empty(4, np.int64)
        places, balls = np.array([each.place for each, _ in others]), np.array([each.ball for each, _ in others])
        reaches = np.array([(look.above, look.below) for _, look in others])
        radius, size = self.balloon.radius, np.array((lens.width, lens.height))
        seen = window_of(places, balls, reaches, radius, np.array(lens.full), place, back, size, box)
        return box if seen else None

    def _draw(
        self,
        patch: Words,
        lens: FieldLens,
        left: int,
        top: int,
        others: list[tuple[Sight, Look]],
        place: Floats,
        back: Floats,
    ) -> None:
        """Draw frames and balls into a window, the farthest first."""
        window = lens.full._replace(cx=lens.full.cx - left, cy=lens.full.cy - top)
        pinhole = np.array(window)
        things: list[tuple[float, Sight, Backdrop | None]] = []
        for sight, look in others:
            if look.parts is not None:
                things.append((math.dist(sight.place, place), sight, look.parts))
            if look.ball:
                things.append((math.dist(sight.ball, place), sight, None))
        for _, sight, parts in sorted(things, key=lambda thing: -thing[0]):
            if parts is not None:
                parts.draw(patch, window, back @ sight.turn, back @ (sight.place - place))
            else:
                radius = self.balloon.radius
                draw_ball(patch, pinhole, place, back, sight.ball, sight.turn, radius, self._looks)

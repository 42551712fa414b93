"""What the camera of a flying vehicle sees: `Eye`, which draws the room, the others and their balls, field by field.

A field is a picture of its own with half the lines: an interlaced sensor adds up pairs of lines.
"""

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.localization.camera_model import CameraModel
from matchset.sim.airframe import placed
from matchset.sim.backdrop import Backdrop
from matchset.sim.balloon import Balloon
from matchset.sim.renderer import Picture, draw_balloon
from matchset.sim.surface import Surface

Floats = npt.NDArray[np.float64]

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
        self.fields = 2 if interlaced else 1
        self._lenses = [_field_lens(camera, self.fields, k) for k in range(self.fields)]

    def expose(self, field: int, place: Floats, turn: Floats, others: list[tuple[Sight, list[Surface]]]) -> Picture:
        """Draw one field.

        Parameters
        ----------
        field : int
            0 or 1.
        place, turn : (3,), (3, 3)
            Of the camera in the room.
        others : list of (Sight, list of Surface)
            Whom it may see, and what they look like in their body frame.

        Returns
        -------
        ndarray of shape (h / fields, w, 3), float32
            BGR, 0 ... 255.
        """
        pinhole, maps = self._lenses[field]
        picture = np.zeros((pinhole.height, pinhole.width, 3), np.float32)
        self.backdrop.draw(picture, pinhole, turn, place)
        things: list[tuple[float, Sight, list[Surface] | None]] = []
        for sight, looks in others:
            things.append((float(np.linalg.norm(sight.place - place)), sight, looks))
            things.append((float(np.linalg.norm(sight.ball - place)), sight, None))
        for _, sight, parts in sorted(things, key=lambda thing: -thing[0]):
            if parts is None:
                self._draw_ball(picture, pinhole, sight, place, turn)
            elif parts:
                Backdrop(placed(parts, sight.turn, sight.place)).draw(picture, pinhole, turn, place)
        if maps is None:
            return picture
        return np.asarray(cv2.remap(picture, *maps, cv2.INTER_LINEAR), np.float32)

    def join(self, fields: list[Picture]) -> Picture:
        """Weave fields into a frame."""
        if len(fields) == 1:
            return fields[0]
        frame = np.empty((self.camera.height, self.camera.width, 3), np.float32)
        for k, field in enumerate(fields):
            frame[k :: len(fields)] = field
        return frame

    def _draw_ball(self, picture: Picture, pinhole: CameraModel, sight: Sight, place: Floats, turn: Floats) -> None:
        center = turn.T @ (sight.ball - place)
        if center[2] < self.balloon.radius + 0.05:
            return  # beside or behind the camera
        marker = turn.T @ (sight.turn @ BACKWARD)
        marker /= np.linalg.norm(marker)
        ball = msgspec.structs.replace(self.balloon, marker=(float(marker[0]), float(marker[1]), float(marker[2])))
        draw_balloon(picture, pinhole, ball, center)


def _field_lens(
    camera: CameraModel, fields: int, field: int
) -> tuple[CameraModel, tuple[npt.NDArray[np.float32], npt.NDArray[np.float32]] | None]:
    """Pinhole camera that draws a field, and how its picture is bent; line r of it is line fields r + field."""
    height = (camera.height - field + fields - 1) // fields
    if not any(camera.distortion):
        return (
            CameraModel(
                width=camera.width,
                height=height,
                fx=camera.fx,
                fy=camera.fy / fields,
                cx=camera.cx,
                cy=(camera.cy - field) / fields,
            ),
            None,
        )
    rows, columns = np.indices((height, camera.width)).reshape(2, -1).astype(np.float64)
    rays = camera.rays(np.column_stack((columns, fields * rows + field)))
    slopes = [(rays[:, k] / rays[:, 2]).reshape(height, camera.width) for k in range(2)]
    fx, fy = camera.fx, camera.fy / fields
    half_x, half_y = (int(np.ceil(f * np.abs(slope).max())) + 2 for f, slope in zip((fx, fy), slopes, strict=True))
    pinhole = CameraModel(width=2 * half_x + 1, height=2 * half_y + 1, fx=fx, fy=fy, cx=float(half_x), cy=float(half_y))
    x, y = fx * slopes[0] + half_x, fy * slopes[1] + half_y
    return pinhole, (x.astype(np.float32), y.astype(np.float32))

"""The pose of the ball, drawn into its frame: `annotate_pose`."""

import math
from collections.abc import Iterable

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import (
    OUTLINE,
    PREDICTED,
    Caption,
    as_color,
    center_of,
    draw_circle,
    draw_points,
    write_captions,
)
from matchset.app.drawing.status_strip import StatusStrip
from matchset.app.drawing.text import draw_text, text_width
from matchset.app.drawing.trail import Trail
from matchset.app.locate.loop import LocatedFrame
from matchset.app.locate.rows import POSITION, PoseRow
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost, Track

Picture = npt.NDArray[np.uint8]

MARKER = (90, 255, 255)  # geometry: color of a marker's circle, BGR
AXES = ((80, 80, 255), (80, 230, 80), (255, 190, 60))  # geometry: colors of the ball's x, y and z axes, BGR
_LEAST_NAME = 13.0  # geometry: least size of an axis's name, px
_LENGTH = 1.7  # geometry: length of the drawn axes, ball radii
_SHIFT = 4  # format: OpenCV draws at 1/16 px


class PosePainter:
    """Draws the poses of a run, with the way that the ball has come, above a strip of text.

    Parameters
    ----------
    camera : CameraModel
    radius : float
        Of the ball, m.
    marked : bool
        Whether the ball has markers: then there is a line for what they show.

    Attributes
    ----------
    size : tuple of two ints
        Width and height of the pictures, px.
    """

    def __init__(self, camera: CameraModel, radius: float, marked: bool) -> None:
        numbers = "x +88.8888 ±8.8888   y +88.8888 ±8.8888   z +88.8888 ±8.8888 m"
        relative = "level:  side +88.888 ±8.888   height +88.888 ±8.888   heading +88.888 ±8.888 m   yaw +888.8°"
        longest = [*([(relative, "")] if marked else []), (numbers, "frame 88888   8888.88 s")]
        self._strip = StatusStrip(camera.width, camera.height, longest)
        self._camera, self._radius, self._trail = camera, radius, Trail()
        self.size = camera.width, camera.height + self._strip.height

    def paint(self, frame: Frame, located: LocatedFrame) -> Picture:
        """Draw the next pose into a copy of its frame, see `annotate_pose`; (h + strip, w, 3), BGR."""
        image, row = as_color(frame.image), located.row
        self._trail.append(center_of(located.ball))
        self._trail.draw(image)
        draw_located(image, located.ball, located.markers, located.pose, self._camera, self._radius)
        texts = [(describe_position(row), f"frame {row.frame}   {row.time:.2f} s")]
        if row.observed in ("level", "full"):
            texts.insert(0, (describe_relative_pose(row), ""))
        return self._strip.below(image, texts, OUTLINE if row.found else PREDICTED)


def annotate_pose(frame: Frame, located: LocatedFrame, camera: CameraModel, radius: float) -> Picture:
    """Draw a pose into a copy of its frame.

    Parameters
    ----------
    frame : Frame
        The frame.
    located : LocatedFrame
        What was found in it.
    camera : CameraModel
        Its camera.
    radius : float
        Radius of the ball, m.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR, with the ball's outline, its match-set, its markers and, where the rotation is observed, the axes of the
        ball frame (x red, y green, z blue); its distance beside it, and the numbers of the row below.
    """
    image, row = as_color(frame.image), located.row
    draw_located(image, located.ball, located.markers, located.pose, camera, radius)
    above = (Caption(describe_relative_pose(row)),) if row.observed in ("level", "full") else ()
    time = f"frame {row.frame}   {row.time:.2f} s"
    write_captions(image, *above, Caption(describe_position(row), time, bad=not row.found))
    return image


def draw_located(
    image: Picture,
    ball: Track[Circle] | Lost[Circle],
    markers: Iterable[Track[Circle]],
    pose: Pose | Lost[Pose],
    camera: CameraModel,
    radius: float,
) -> None:
    """Draw a ball's outline with its match-set (or, dashed, its prediction), its markers, its axes and its distance.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8, written
    ball, markers, pose
        What was found in it.
    camera : CameraModel
        Its camera.
    radius : float
        Radius of the ball, m.
    """
    if isinstance(ball, Track):
        draw_points(image, ball.match_set)
        draw_circle(image, ball.shape)
    elif ball.predicted is not None:
        draw_circle(image, ball.predicted, PREDICTED, dashed=True)
    for marker in markers:
        draw_circle(image, marker.shape, MARKER)
    if isinstance(pose, Pose) and isinstance(ball, Track):
        draw_axes(image, pose, camera, radius)
        label_ball(image, f"{pose.distance:.2f} m", ball.shape.x, ball.shape.y, ball.shape.radius)


def describe_position(row: PoseRow) -> str:
    """Format the position of the ball: ``x +0.1212 ±0.0011   y -0.0401 ±0.0009   z +1.9120 ±0.0084 m``."""
    if row.values is None:
        return f"Lost: {row.reason}"
    return "   ".join(_with_std(row, name, 4) for name in POSITION) + " m"


def describe_relative_pose(row: PoseRow) -> str:
    """Format the camera's position relative to the ball: ``level:  side +0.121 ±0.021   ...   yaw +3.1°``."""
    if row.values is None or "side" not in row.values:
        return ""
    yaw_deg = math.degrees(row.values["yaw"])
    numbers = "   ".join(_with_std(row, name, 3) for name in ("side", "height", "heading"))
    return f"{row.observed}:  {numbers} m   yaw {yaw_deg:+z.1f}°"


def _with_std(row: PoseRow, name: str, digits: int) -> str:
    value = (row.values or {})[name]
    std = (row.std or {}).get(name)
    return f"{name} {value:+z.{digits}f}" + ("" if std is None else f" ±{std:.{digits}f}")


def draw_axes(image: Picture, pose: Pose, camera: CameraModel, radius: float) -> None:
    """Draw the axes of the ball frame (x red, y green, z blue) into a picture, where the rotation is observed."""
    if pose.rotation_matrix is None:
        return
    ends = pose.position + _LENGTH * radius * pose.rotation_matrix.T
    # Far axes first, so that a nearer one is drawn over them.
    for axis in np.argsort(-ends[:, 2]).tolist():
        line = np.array((pose.position + 0.4 * (ends[axis] - pose.position), ends[axis]))
        if (line[:, 2] <= 0.1 * radius).any() or not _drawable(camera, line):
            continue
        begin, end = (tuple(round(float(part) * (1 << _SHIFT)) for part in point) for point in camera.project(line))
        for color, width in (((30, 30, 30), 4), (AXES[axis], 2)):
            cv2.line(image, begin, end, color, width, cv2.LINE_AA, _SHIFT)
        _name_axis(image, axis, camera.project(line))


def _drawable(camera: CameraModel, points: npt.NDArray[np.float64]) -> bool:
    try:
        return bool(np.abs(camera.project(points)).max() < 2**20)
    except ValueError:  # outside the region in which the lens model is defined
        return False


def label_ball(image: Picture, words: str, x: float, y: float, radius: float) -> None:
    """Write above a ball or, at the upper border, below it."""
    height, width = image.shape[:2]
    size = min(max(14, round(height / 24)), 40)
    wide = text_width(words, size)
    left = min(max(x - wide / 2.0, 4.0), width - wide - 4.0)
    above = y - radius - 0.9 * size
    middle = above if above > 0.7 * size else min(y + radius + 0.9 * size, height - 5.0 * size)
    _write_outlined(image, words, (left, middle), size)


def _name_axis(image: Picture, axis: int, line: npt.NDArray[np.float64]) -> None:
    """Write x, y or z beyond the end of a drawn axis."""
    size = round(min(max(_LEAST_NAME, min(image.shape[:2]) / 30.0), 30.0))
    along = line[1] - line[0]
    length = float(np.hypot(*along))
    beyond = along / length if length > 1.0 else np.array((0.7, -0.7))
    x, y = (line[1] + 0.75 * size * beyond).tolist()
    name = "xyz"[axis]
    _write_outlined(image, name, (x - text_width(name, size) / 2.0, y), size, AXES[axis])


def _write_outlined(
    image: Picture, words: str, at: tuple[float, float], size: int, color: tuple[int, int, int] = (255, 255, 255)
) -> None:
    """Write with a dark outline, to be read before anything."""
    for shift in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        draw_text(image, words, (at[0] + shift[0], at[1] + shift[1]), size, (20, 20, 20))
    draw_text(image, words, at, size, color)

"""The pose of the ball, drawn into its frame: `annotate_pose`."""

import math
from collections.abc import Iterable

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import PREDICTED, as_color, caption, draw_circle, draw_points
from matchset.app.drawing.text import draw_text, text_width
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
_LENGTH = 1.7  # geometry: length of the drawn axes, ball radii
_SHIFT = 4  # format: OpenCV draws at 1/16 px


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
    if row.observed in ("level", "full"):
        caption(image, describe_relative_pose(row), line=1)
    caption(image, describe_position(row), f"frame {row.frame}   {row.time:.2f} s", bad=not row.found)
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
    """Format the position of the ball: ``x +0.121 ±0.0011   y -0.040 ±0.0009   z +1.912 ±0.0084 m``."""
    if row.values is None:
        return f"Lost: {row.reason}"
    return "   ".join(_with_std(row, name, "+z.3f", ".4f") for name in POSITION) + " m"


def describe_relative_pose(row: PoseRow) -> str:
    """Format the camera's position relative to the ball: ``level:  side +0.12 ±0.021   ...   yaw +3.1°``."""
    if row.values is None or "side" not in row.values:
        return ""
    yaw_deg = math.degrees(row.values["yaw"])
    numbers = "   ".join(_with_std(row, name, "+z.2f", ".3f") for name in ("side", "height", "heading"))
    return f"{row.observed}:  {numbers} m   yaw {yaw_deg:+z.1f}°"


def _with_std(row: PoseRow, name: str, number: str, deviation: str) -> str:
    value = (row.values or {})[name]
    std = (row.std or {}).get(name)
    return f"{name} {value:{number}}" + ("" if std is None else f" ±{std:{deviation}}")


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
    for shift in ((-1, 0), (1, 0), (0, -1), (0, 1)):
        draw_text(image, words, (left + shift[0], middle + shift[1]), size, (20, 20, 20))
    draw_text(image, words, (left, middle), size)

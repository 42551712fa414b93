"""Answers drawn into pictures, for programs and notebooks: `draw` for tracks, `draw_pose` for poses."""

import math
from collections.abc import Iterable
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import (
    OUTLINE,
    PREDICTED,
    Caption,
    as_color,
    describe,
    draw_points,
    draw_shape,
    write_captions,
)
from matchset.app.locate.annotate_pose import describe_position, describe_relative_pose, draw_axes, label_ball
from matchset.app.locate.rows import pose_row
from matchset.app.track.rows import track_row
from matchset.camera.camera_model import CameraModel
from matchset.image.display.png import png_of
from matchset.image.frame import Picture, image_of
from matchset.localization.pose import Pose
from matchset.numeric.arguments import check_kind, check_number
from matchset.tracking.track import Lost, Track

Found = Track[Any] | Lost[Any]

OUTLINE_TURNS = 2.0 * math.pi * np.arange(90) / 90  # geometry: points of a drawn ball's outline
ARM = 0.07  # geometry: stands for the ball's radius where that is not known, in its distance: 4 degrees


class Drawing(npt.NDArray[np.uint8]):
    """A picture that something was drawn into: an array as any other, and in a notebook a picture."""

    def _repr_png_(self) -> bytes | None:
        """Show it in a notebook, as long as it is a picture."""
        sound = self.dtype == np.uint8 and self.size and self.ndim == 3 and self.shape[2] == 3
        return png_of(np.asarray(self)) if sound else None


def draw(image: Picture, track: Found | Iterable[Found], words: bool = True) -> Drawing:
    """Draw what was found into a copy of its picture: "show me".

    Parameters
    ----------
    image : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray; it is not changed.
    track : Track or Lost, or an iterable of them
        What `Tracker.update` or `detect` returned for it.
    words : bool
        Whether to write numbers, or the reason of a loss, below.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR: each outline with its match-set, or, dashed, where a lost shape is expected. Notebooks show it.

    Raises
    ------
    ValueError
        If the picture is none.
    TypeError
        If there is something else among the tracks.
    """
    given = [track] if isinstance(track, Track | Lost) else list(track)
    for each in given:
        check_kind("what is drawn", each, (Track, Lost), "Tracker.update(frame) gives one")
    drawn = as_color(image_of(image))
    for each in given:
        if isinstance(each, Track):
            draw_points(drawn, each.match_set)
            draw_shape(drawn, each.shape)
        elif each.predicted is not None:
            draw_shape(drawn, each.predicted, PREDICTED, dashed=True)
    if words:
        count = sum(map(bool, given))
        text = describe(track_row(0, given[0])) if len(given) == 1 else f"{count} found"
        write_captions(drawn, Caption(text, bad=not count))
    return drawn.view(Drawing)


def draw_pose(
    image: Picture, pose: Pose | Lost[Pose], camera: CameraModel, diameter: float | None = None, words: bool = True
) -> Drawing:
    """Draw a pose into a copy of its picture: the ball's center, its distance, and its axes where they are observed.

    Parameters
    ----------
    image : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray; it is not changed.
    pose : Pose or Lost
        What `Localizer.update` returned for it.
    camera : CameraModel
        What took the picture.
    diameter : float, optional
        Of the ball, m: its outline is drawn as this pose would show it, a test of pose and camera.
    words : bool
        Whether to write the numbers, or the reason of a loss, below.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR; the axes of the ball frame are x red, y green, z blue. Notebooks show it.

    Raises
    ------
    ValueError
        If the picture is none or not of the camera's size, or the diameter is not positive.
    TypeError
        If it is no pose, or no camera.
    """
    check_kind("pose", pose, (Pose, Lost), "Localizer.update(track) gives one")
    check_kind("camera", camera, CameraModel)
    if diameter is not None:
        check_number("diameter", diameter)
        if not 0.0 < diameter < math.inf:
            raise ValueError(f"diameter must be positive, m, got {diameter}")
    drawn = as_color(image_of(image))
    camera.check(drawn)
    row = pose_row(0, pose)
    if isinstance(pose, Pose):
        _draw_ball(drawn, pose, camera, diameter)
    if words:
        level = isinstance(pose, Pose) and pose.observed != "position"
        above = (Caption(describe_relative_pose(row)),) if level else ()
        write_captions(drawn, *above, Caption(describe_position(row), bad=not row.found))
    return drawn.view(Drawing)


def _draw_ball(image: npt.NDArray[np.uint8], pose: Pose, camera: CameraModel, diameter: float | None) -> None:
    """Draw what is known of a ball: outline or cross, axes, distance."""
    radius = ARM * pose.distance if diameter is None else 0.5 * diameter
    ring = _project(camera, _outline(pose, radius))
    if ring is None:
        return
    draw_axes(image, pose, camera, radius)
    x, y = ring.mean(axis=0).tolist()
    if diameter is None:
        center = round(x), round(y)
        cv2.drawMarker(image, center, OUTLINE, cv2.MARKER_CROSS, 21, 1, cv2.LINE_AA)
    else:
        fixed = np.rint(16.0 * ring).astype(np.int32).reshape(-1, 1, 2)
        cv2.polylines(image, [fixed], True, OUTLINE, 2 if min(image.shape[:2]) > 900 else 1, cv2.LINE_AA, 4)
    label_ball(image, f"{pose.distance:.2f} m", x, y, 0.5 * float(np.ptp(ring[:, 1])))


def _outline(pose: Pose, radius: float) -> npt.NDArray[np.float64]:
    """Points where the rays from the camera touch a sphere, (n, 3), m."""
    toward = pose.position / pose.distance
    sine = min(radius / pose.distance, 1.0)
    across = np.cross(toward, (0.0, 1.0, 0.0) if abs(toward[1]) < 0.9 else (1.0, 0.0, 0.0))
    across /= np.linalg.norm(across)
    around = np.outer(np.cos(OUTLINE_TURNS), across) + np.outer(np.sin(OUTLINE_TURNS), np.cross(toward, across))
    cosine = math.sqrt(1.0 - sine * sine)
    found: npt.NDArray[np.float64] = cosine * cosine * pose.position + radius * cosine * around
    return found


def _project(camera: CameraModel, points: npt.NDArray[np.float64]) -> npt.NDArray[np.float64] | None:
    """Project points into the picture, px; None where the camera does not see them."""
    try:
        pixels = camera.project(points)
    except ValueError:  # behind it, or outside the region in which the lens model is defined
        return None
    return pixels if bool((np.abs(pixels) < 2**20).all()) else None

"""Answers drawn into pictures, for programs and notebooks: `draw` for tracks, `draw_pose` for poses."""

import itertools
import math
import operator
from collections.abc import Iterable, Sequence
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

from matchset.app.drawing.annotate import (
    OUTLINE,
    Caption,
    Color,
    as_color,
    center_of,
    describe,
    draw_answer,
    write_captions,
)
from matchset.app.drawing.trail import Trail
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

TARGETS = (
    (233, 180, 86),
    (0, 159, 230),
    (115, 158, 0),
    (66, 228, 240),
    (167, 121, 204),
    (0, 94, 213),
    (178, 114, 0),
)  # format: BGR, those of the live page in its order (Okabe & Ito, told apart by the color-blind)

GIVEN = "Tracker.update(frame) gives one"  # format: where what is drawn comes from
OUTLINE_TURNS = 2.0 * math.pi * np.arange(90) / 90  # geometry: points of a drawn ball's outline
ARM = 0.07  # geometry: stands for the ball's radius where that is not known, in its distance: 4 degrees


class Drawing(npt.NDArray[np.uint8]):
    """A picture that something was drawn into: an array as any other, and in a notebook a picture."""

    def _repr_png_(self) -> bytes | None:
        """Show it in a notebook, as long as it is a picture."""
        sound = self.dtype == np.uint8 and self.size and self.ndim == 3 and self.shape[2] == 3
        return png_of(np.asarray(self)) if sound else None


def draw(
    image: Picture,
    track: Found | Iterable[Found],
    words: bool = True,
    *,
    trail: Iterable[Found] | Iterable[Iterable[Found]] | None = None,
    colors: Sequence[Color] | None = None,
) -> Drawing:
    """Draw what was found into a copy of its picture: "show me".

    Parameters
    ----------
    image : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
        BGR or gray; it is not changed.
    track : Track or Lost, or an iterable of them
        What `Tracker.update` or `detect` returned for it.
    words : bool
        Whether to write numbers, or the reason of a loss, below.
    trail : iterable of Track or Lost, optional
        Earlier answers, oldest first: the way of the last 40 is drawn as a fading line, which a loss interrupts. For
        several tracks one such iterable for each.
    colors : sequence of (blue, green, red), optional
        0 ... 255, one for each track, in their order, from the first again where there are more tracks. By default one
        track is pink, and of several each has a color of its own.

    Returns
    -------
    ndarray of shape (h, w, 3), uint8
        BGR: each outline with its match-set, or, dashed, where a lost shape is expected. Notebooks show it.

    Raises
    ------
    ValueError
        If the picture is none, a color is none, or there are not as many trails as tracks.
    TypeError
        If there is something else among the tracks or in a trail.
    """
    given = answers_of(track)
    drawn = as_color(image_of(image))
    chosen = _chosen(colors, len(given))
    for way, answer, color in zip(_ways(trail, track, len(given)), given, chosen, strict=True):
        _draw_way(drawn, [*way, answer], color)
    for answer, color in zip(given, chosen, strict=True):
        draw_answer(drawn, answer, color)
    if words:
        count = sum(map(bool, given))
        text = describe(track_row(0, given[0])) if len(given) == 1 else f"{count} found"
        write_captions(drawn, Caption(text, bad=not count))
    return drawn.view(Drawing)


def answers_of(track: Found | Iterable[Found]) -> list[Found]:
    """Return the answers for a frame: one alone, or those of an iterable.

    Parameters
    ----------
    track : Track or Lost, or an iterable of them

    Raises
    ------
    TypeError
        If it is, or holds, something else.
    """
    one: Any = track
    given = list(one) if isinstance(one, Iterable) and not isinstance(one, str | bytes) else [one]
    instead = "draw_pose draws a pose" if any(isinstance(each, Pose) for each in given) else GIVEN
    for each in given:
        check_kind("what is drawn", each, (Track, Lost), instead)
    return given


def _chosen(colors: Sequence[Color] | None, count: int) -> list[Color | None]:
    """Return a color for each of so many tracks; None: what is found and what is expected have colors of their own."""
    if colors is None:
        return [None] if count == 1 else [TARGETS[number % len(TARGETS)] for number in range(count)]
    given = [_color(each) for each in colors]
    if not given:
        raise ValueError("colors must have one color (blue, green, red) or more, got none")
    return [given[number % len(given)] for number in range(count)]


def _color(value: Any) -> Color:
    """Return a color, checked."""
    try:
        blue, green, red = (operator.index(each) for each in value)
    except (TypeError, ValueError):
        blue = -1
    if isinstance(value, str) or blue < 0 or not all(0 <= each <= 255 for each in (blue, green, red)):
        raise ValueError(f"a color must be (blue, green, red) of whole numbers 0 ... 255, got {value!r:.60}")
    return blue, green, red


def _ways(trail: Any, track: Found | Iterable[Found], count: int) -> list[list[Found]]:
    """Return the earlier answers of each of so many tracks."""
    given = [] if trail is None else list(trail)
    if not given:
        return [[]] * count
    flat = [each for each in given if isinstance(each, Track | Lost)]
    single = isinstance(track, Track | Lost) or (count == 1 and bool(flat))
    ways: list[list[Found]] = [given] if single else [] if flat else [list(each) for each in given]
    if len(ways) != count:
        raise ValueError(f"there must be one trail for each of {count} tracks, got {len(ways) or 'one for all'}")
    for each in itertools.chain(*ways):
        check_kind("what a trail holds", each, (Track, Lost), GIVEN)
    return ways


def _draw_way(image: npt.NDArray[np.uint8], answers: list[Found], color: Color | None) -> None:
    """Draw the way that a target has come; nothing where there is but the last answer."""
    trail = Trail()
    for each in answers if len(answers) > 1 else []:
        trail.append(center_of(each))
    trail.draw(image, *([] if color is None else [color]))


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

"""Something that was clicked and is followed since: `Target`."""

import itertools
import math
from typing import Any

import numpy as np

from matchset.app.live.targets.messages import Outline, Pick
from matchset.app.live.wire.state import TargetState
from matchset.app.track.shape_option import parse_shape
from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.shapes.shape import outline
from matchset.tracking.track import Lost
from matchset.tracking.tracker import Tracker

OUTLINE_POINTS = 72  # geometry: of an outline that a browser draws
TENTH = 10.0  # format: coordinates on the screen have one decimal


class Target:
    """Follows one shape, and places it where its diameter and the camera are known.

    Parameters
    ----------
    number : int
        Its number on the page.
    begin : Pick or Outline
        What a person did.
    frame : Frame
        In which picture.

    Attributes
    ----------
    diameter : float or None
        m
    parameters : tuple of str
        Names of the shape's parameters.
    pose : Pose, Lost or None
        In the last frame; None if diameter or camera are not known.

    Raises
    ------
    ValueError
        If the click is outside of the picture, no color can be learned there, or there is no such shape.
    """

    def __init__(self, number: int, begin: Pick | Outline, frame: Frame) -> None:
        height, width = frame.image.shape[:2]
        if not (0.0 <= begin.x < width and 0.0 <= begin.y < height):
            raise ValueError(f"({begin.x:g}, {begin.y:g}) is outside of the picture of {width} x {height} px")
        family = parse_shape(begin.shape)
        color = ColorModel.pick(frame.image, begin.x, begin.y)
        self.number, self.name = number, f"{begin.shape} {number}"
        self.note, self.parameters = color.note, tuple(family.parameters)
        self.diameter: float | None = None
        self.tracker: Tracker[Any] = Tracker(family, color, start=(begin.x, begin.y))
        if isinstance(begin, Outline) and family is Circle:
            self.tracker.start(Circle(begin.x, begin.y, begin.radius))
        self._localizer: Localizer | None = None
        self.pose: Pose | Lost[Pose] | None = None
        self._seen: float | None = None

    def locate(self, camera: CameraModel | None, diameter: float | None) -> None:
        """Set what is known of camera and target; None: not known.

        Parameters
        ----------
        camera : CameraModel or None
        diameter : float or None
            m
        """
        self.diameter = diameter
        known = camera is not None and diameter is not None
        self._localizer = Localizer(camera, BallTarget(diameter=diameter)) if known else None  # type: ignore[arg-type]

    def update(self, frame: Frame) -> TargetState:
        """Follow it into a frame."""
        answer = self.tracker.update(frame)
        placed = self._localizer is not None and (isinstance(answer, Lost) or isinstance(answer.shape, Circle))
        self.pose = self._localizer.update(answer) if placed else None  # type: ignore[union-attr]
        if isinstance(answer, Lost):
            since = 0.0 if self._seen is None else max(answer.time - self._seen, 0.0)
            return TargetState(
                self.number, self.name, False, reason=answer.reason, lost_for=since, diameter=self.diameter
            )
        self._seen = answer.time
        return TargetState(
            self.number,
            self.name,
            True,
            values=answer.measured(),
            outline=_flat(outline(answer.shape, OUTLINE_POINTS)),
            match_set=_flat(answer.match_set),
            support=float(answer.support),
            position=self._position(),
            diameter=self.diameter,
        )

    def without_picture(self, reason: str) -> TargetState:
        """Say that it is lost because there is no picture."""
        self.pose = None
        return TargetState(self.number, self.name, False, reason=reason, diameter=self.diameter)

    def _position(self) -> dict[str, tuple[float, float | None]]:
        pose = self.pose
        if pose is None or isinstance(pose, Lost):
            return {}
        sigmas = np.sqrt(np.diagonal(pose.covariance)[:3]).tolist()
        along = pose.position / pose.distance
        spread = math.sqrt(max(float(along @ pose.covariance[:3, :3] @ along), 0.0))
        placed = dict(zip("xyz", zip(pose.position.tolist(), sigmas, strict=True), strict=True))
        return {**placed, "distance": (pose.distance, spread)}


def catch_up(target: Target, frames: list[Frame]) -> None:
    """Follow a target through the frames since the click, so that it is where the newest one is."""
    for frame in frames:
        target.update(frame)


def _flat(points: Any) -> list[float]:
    """Write points as numbers one after the other, px."""
    return list(itertools.chain.from_iterable((np.rint(points * TENTH) / TENTH).tolist()))

"""What a follower sees, as a stream of the page: `FollowerStream`."""

import math
import time
from typing import Any

import numpy as np

from matchset.app.flight.pilot import PilotStep
from matchset.app.live.feed import Seen
from matchset.app.live.wire.state import State, TargetState
from matchset.camera.camera_model import CameraModel
from matchset.image.frame import Frame
from matchset.localization.pose import Pose
from matchset.shapes.shape import outline
from matchset.tracking.track import Lost

OUTLINE_POINTS = 72  # geometry: of an outline that a browser draws
TENTH = 1  # format: digits of coordinates on the screen


class FollowerStream:
    """The pictures of one follower, with the ball that it follows.

    Parameters
    ----------
    number : int
        Of the follower, from 0.

    Attributes
    ----------
    seen : Seen
        The newest picture.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.seen = Seen(None, State(0, 0, time.monotonic(), 0, 0, fault="getting ready ..."))
        self._found_time = math.nan

    def show(self, step: PilotStep, sequence: int, rate: float | None, camera: CameraModel) -> None:
        """Show a step of the follower's loop.

        Parameters
        ----------
        step : PilotStep
        sequence : int
            Its number on the page.
        rate : float or None
            Pictures per second.
        camera : CameraModel
        """
        frame: Frame | None = step.frame or self.seen.frame
        height, width = (0, 0) if frame is None else frame.image.shape[:2]
        age = step.age if math.isfinite(step.age) else 0.0
        state = State(
            sequence=sequence,
            index=0 if frame is None else frame.index,
            time=time.monotonic() - age,
            width=width,
            height=height,
            targets=[self._ball(step)],
            camera_fps=rate,
            fps=rate,
            age=age,
            fault="" if step.frame is not None else "no picture comes",
        )
        self.seen = Seen(frame, state, {1: step.pose}, camera)

    def fail(self, words: str, sequence: int) -> None:
        """Show the last picture, and in words what is wrong."""
        old = self.seen.state
        state = State(sequence, old.index, old.time, old.width, old.height, fault=words)
        self.seen = Seen(self.seen.frame, state)

    def _ball(self, step: PilotStep) -> TargetState:
        """Return what is known of the neighbor's ball."""
        name = f"ball of vehicle {self.number + 2}"
        if isinstance(step.ball, Lost):
            if math.isnan(self._found_time):
                self._found_time = step.now
            return TargetState(1, name, False, reason=step.ball.reason, lost_for=step.now - self._found_time)
        self._found_time = step.now
        return TargetState(
            1,
            name,
            True,
            values=step.ball.measured(),
            outline=_flat(outline(step.ball.shape, OUTLINE_POINTS)),
            match_set=_flat(step.ball.match_set),
            support=float(step.ball.support),
            position=_position(step.pose) if isinstance(step.pose, Pose) else {},
        )


def _position(pose: Pose) -> dict[str, tuple[float, float | None]]:
    sigmas = np.sqrt(np.diagonal(pose.covariance)[:3]).tolist()
    along = pose.position / pose.distance
    spread = math.sqrt(max(float(along @ pose.covariance[:3, :3] @ along), 0.0))
    placed: dict[str, tuple[float, float | None]] = dict(
        zip("xyz", zip(pose.position.tolist(), sigmas, strict=True), strict=True)
    )
    return {**placed, "distance": (pose.distance, spread)}


def _flat(points: Any) -> list[float]:
    """Write points as numbers one after the other, px."""
    rounded: list[float] = np.round(points, TENTH).ravel().tolist()
    return rounded

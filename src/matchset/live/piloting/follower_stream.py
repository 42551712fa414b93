"""What a follower sees, as a stream of the page: `FollowerStream`."""

import math
import time

from matchset.app.timing.durations import ShownTimes
from matchset.flight.chain.pilot import Pilot, PilotStep
from matchset.image.frame import Frame
from matchset.live.feed import StreamPicture
from matchset.live.targets.target_facts import TargetFacts, found_state, lost_state
from matchset.live.targets.target_localizer import TargetPlace, axes_of, position_of
from matchset.live.wire.state import State, TargetState
from matchset.localization.pose import Pose
from matchset.shapes.circle import Circle
from matchset.tracking.track import Lost


class FollowerStream:
    """The pictures of one follower, with the ball that it follows.

    Parameters
    ----------
    number : int
        Of the follower, from 0.

    Attributes
    ----------
    seen : StreamPicture
        The newest picture.
    """

    def __init__(self, number: int) -> None:
        self.number = number
        self.seen = StreamPicture(None, State(0, 0, time.monotonic(), 0, 0, fault="getting ready ..."))
        self._found_time, self._computing = math.nan, ShownTimes()

    def show(self, step: PilotStep, sequence: int, rate: float | None, pilot: Pilot) -> None:
        """Show a step of the follower's loop.

        Parameters
        ----------
        step : PilotStep
        sequence : int
            Its number on the page.
        rate : float or None
            Pictures per second.
        pilot : Pilot
            Whose camera and ball.
        """
        frame: Frame | None = step.frame or self.seen.frame
        height, width = (0, 0) if frame is None else frame.image.shape[:2]
        age = step.age if math.isfinite(step.age) else 0.0
        if step.frame is not None:
            self._computing.add(step.processing)
        state = State(
            sequence=sequence,
            index=0 if frame is None else frame.index,
            time=time.monotonic() - age,
            width=width,
            height=height,
            targets=[self._ball(step, pilot)],
            camera_fps=rate,
            fps=rate,
            age=age,
            computing=self._computing.in_ms,
            fault="" if step.frame is not None else "no picture comes",
        )
        self.seen = StreamPicture(frame, state, {1: step.pose}, pilot.camera.model)

    def fail(self, words: str, sequence: int) -> None:
        """Show the last picture, and in words what is wrong."""
        old = self.seen.state
        state = State(sequence, old.index, old.time, old.width, old.height, fault=words)
        self.seen = StreamPicture(self.seen.frame, state)

    def _ball(self, step: PilotStep, pilot: Pilot) -> TargetState:
        """Return what is known of the neighbor's ball."""
        about = TargetFacts(1, f"ball of vehicle {self.number + 2}")
        if isinstance(step.ball, Lost):
            if math.isnan(self._found_time):
                self._found_time = step.now
            return lost_state(about, step.ball.reason, step.now - self._found_time)
        self._found_time = step.now
        if not isinstance(step.pose, Pose):
            return found_state(about, step.ball, TargetPlace(step.pose, markers=shapes_of(step)))
        axes = axes_of(step.pose, pilot.camera.model, pilot.parameters.target.radius)
        return found_state(about, step.ball, TargetPlace(step.pose, position_of(step.pose), shapes_of(step), axes))


def shapes_of(step: PilotStep) -> tuple[Circle, ...]:
    """Return the markers that a follower sees."""
    return tuple(marker.shape for marker in step.markers)

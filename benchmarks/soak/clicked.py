"""A tracker and a localizer that see what a pilot sees, while somebody clicks at random: `ClickedTracker`."""

import time
from array import array

import numpy as np

from benchmarks.soak.invariants import InvariantParameters, pose_wrong, track_not_confirmed
from matchset.camera.camera_model import CameraModel
from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.localization.ball_target import BallTarget
from matchset.localization.localizer import Localizer
from matchset.localization.markers.marker_tracker import MarkerTracker
from matchset.shapes.circle import Circle
from matchset.tracking.track import Track
from matchset.tracking.tracker import Tracker

KINDS = 4  # of what a click may ask for


class ClickedTracker:
    """Tracks and locates the ball, restarted by clicks anywhere; its updates are timed.

    Parameters
    ----------
    colors : tuple of ColorModel
        Of the ball with its marker, and of the marker.
    model : CameraModel
    target : BallTarget
    clicks : float
        Share of the pictures at which somebody clicks.
    seed : tuple of int

    Attributes
    ----------
    clicked : int
        How often.
    elapsed, computed : array of float
        For each update, time on the clock and computing time of the thread, s.
    """

    def __init__(
        self,
        colors: tuple[ColorModel, ColorModel],
        model: CameraModel,
        target: BallTarget,
        clicks: float,
        seed: tuple[int, ...],
    ) -> None:
        ball, marker = colors
        self._tracker = Tracker(Circle, ball)
        self._markers, self._localizer = MarkerTracker(marker, target), Localizer(model, target)
        self._clicks, self._rng = clicks, np.random.default_rng(seed)
        self.clicked = 0
        self.elapsed, self.computed = array("d"), array("d")

    def update(self, frame: Frame, fault: str, limits: InvariantParameters) -> str:
        """Track into a picture; says what is wrong with the answer, empty if nothing is."""
        if self._rng.random() < self._clicks:
            self._click(*frame.image.shape[:2])
        begin, computing = time.perf_counter(), time.thread_time()
        ball = self._tracker.update(frame)
        self.computed.append(time.thread_time() - computing)
        self.elapsed.append(time.perf_counter() - begin)
        markers = self._markers.update(frame, ball)
        pose = self._localizer.update(ball, markers)
        for track in [each for each in (ball, *markers) if isinstance(each, Track)]:
            wrong = "a track in a picture of noise" if fault == "noise" else track_not_confirmed(track, frame, limits)
            if wrong:
                return f"clicked tracker: {wrong}"
        wrong = pose_wrong(pose)
        return f"clicked tracker: {wrong}" if wrong else ""

    def _click(self, height: int, width: int) -> None:
        self.clicked += 1
        x, y = float(self._rng.uniform(-0.5, width - 0.5)), float(self._rng.uniform(-0.5, height - 0.5))
        circle = Circle(x, y, float(self._rng.uniform(4.0, 0.4 * height)))
        kind = int(self._rng.integers(0, KINDS))
        if kind == 0:
            self._tracker.restart()
        elif kind == 1:
            self._tracker.restart((x, y))
        elif kind == 2:
            self._tracker.restart(circle)
        else:
            self._tracker.start(circle)

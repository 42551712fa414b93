"""Corrects the focal length by a ball that is held still at a known distance: `BallDistance`, a thread."""

import threading
import time
from collections.abc import Callable
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.calibrate.still_ball import StillInterval, still_intervals
from matchset.camera.ball_focal_length import HeldBall
from matchset.camera.camera_model import CameraModel
from matchset.camera.one_ball_focal import focal_from_one_ball
from matchset.live.camera.camera_source import CameraSource, newest_pictures
from matchset.live.wire.state import TargetState
from matchset.media.closing import Closing
from matchset.shapes.circle import Circle


class BallDistanceParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a ball is measured.

    Parameters
    ----------
    frames : int
        In which it is held still. More averages more, and asks for a steadier hand. Chosen by hand: the number of
        outlines that `focal_from_one_ball` takes for independent, twice.
    patience : float
        Time in which that must come about, s. Chosen by hand.
    soon : float
        Time in which the ball's diameter must be known, s: it may have been typed just before.
    thought_fov : float
        Horizontal field of view, rad, with which the search begins if nothing is known; it decides nothing.
    """

    frames: int = 20
    patience: float = 20.0
    soon: float = 1.0
    thought_fov: float = 1.0


class SeenCircle(NamedTuple):
    """A ball in a picture.

    Attributes
    ----------
    shape : Circle
    match_set : ndarray of shape (m, 2), float64
        px
    """

    shape: Circle
    match_set: npt.NDArray[np.float64]


class BallDistance(Closing):
    """Waits until a target is held still, then corrects the camera's focal length.

    Parameters
    ----------
    shown : CameraSource
    target : int
        Its number.
    meters : float
        From the lens to the ball's nearest point.
    note : callable
        Told the result, or why there is none.
    parameters : BallDistanceParameters, optional

    Attributes
    ----------
    words : str
        How far it is; empty when it is over.
    """

    def __init__(
        self,
        shown: CameraSource,
        target: int,
        meters: float,
        note: Callable[[str], None],
        parameters: BallDistanceParameters | None = None,
    ) -> None:
        self._shown, self._number, self._note, self._nearest = shown, target, note, meters
        self._diameter, self._parameters = 0.0, parameters or BallDistanceParameters()
        self.words = "hold the ball still"
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="matchset ball", daemon=True)
        self._thread.start()

    def close(self) -> None:
        """End it."""
        self._stop.set()
        self._thread.join()

    def _run(self) -> None:
        try:
            held = self._held()
            if held is not None:
                self._correct(held)
        except ValueError as error:
            self._note(f"the focal length stays: {error}")
        self.words = ""

    def _held(self) -> StillInterval | None:
        """Return the frames in which the ball was held still; None if it was ended."""
        wanted, found = self._parameters, list[tuple[int, SeenCircle]]()
        begin = time.monotonic()
        for seen in newest_pictures(self._shown, self._stop):
            ball = next((each for each in seen.state.targets if each.id == self._number and each.found), None)
            if ball is not None:
                self._diameter = ball.diameter or 0.0
                found.append((seen.state.sequence, _circle(ball)))
            intervals = still_intervals(found[-wanted.frames :])
            if self._diameter and intervals and len(intervals[-1].outlines) >= wanted.frames:
                return intervals[-1]
            if not self._diameter and time.monotonic() > begin + wanted.soon:
                raise ValueError("type the ball's diameter first")
            if time.monotonic() > begin + wanted.patience:
                raise ValueError(f"the ball was not held still for {wanted.frames} pictures")
            self.words = f"hold the ball still: seen in {len(found)} pictures, {wanted.frames} still ones are needed"
        return None

    def _correct(self, held: StillInterval) -> None:
        state, before = self._shown.seen.state, self._shown.seen.camera
        camera = before or CameraModel.from_fov(state.width, state.height, self._parameters.thought_fov)
        radius = self._diameter / 2.0
        corrected = focal_from_one_ball(HeldBall(self._nearest + radius, held.outlines), radius, camera)
        self._shown.use(corrected)
        was = "" if before is None else f", {before.fx:.1f} before"
        sigma = 0.0 if corrected.covariance is None else float(np.sqrt(corrected.covariance[0, 0]))
        self._note(f"the focal length is {corrected.fx:.1f} ± {sigma:.1f} px by the ball{was}")


def _circle(ball: TargetState) -> SeenCircle:
    """Read a ball from what pages are told.

    Raises
    ------
    ValueError
        If it is none.
    """
    if "radius" not in ball.values:
        raise ValueError(f"{ball.name} is no ball: only a ball has one size from all sides")
    x, y, radius = (ball.values[name][0] for name in ("x", "y", "radius"))
    return SeenCircle(Circle(x, y, radius), np.array(ball.match_set, np.float64).reshape(-1, 2))

"""Pictures in which targets are followed as before a camera of the live page, for tests: `Loop`."""

import time
from collections.abc import Callable

import numpy as np
import numpy.typing as npt

from matchset.image.frame import Frame
from matchset.live.targets.followed_targets import FollowedTargets, FollowedTargetsParameters
from matchset.live.vision.kept_frames import KeptFrames
from matchset.live.wire.state import TargetState

PATIENCE = 20.0  # s; only ever spent where a test fails


class Loop:
    """Pictures of a scene, 30 a second, with what is followed.

    Parameters
    ----------
    picture : callable
        Draws the next one.
    """

    def __init__(self, picture: Callable[[], npt.NDArray[np.uint8]]) -> None:
        self.picture, self.number = picture, 0
        self.kept, self.notes = KeptFrames(), list[str]()
        self.followed = FollowedTargets(self.kept, self.notes.append, FollowedTargetsParameters(trial=0.3))
        self.states: list[TargetState] = []
        self.step()

    def step(self) -> None:
        """Follow all into the next picture."""
        frame = Frame(self.picture(), self.number / 30.0, self.number)
        self.number += 1
        self.states = self.followed.update(frame)
        self.kept.add(self.number, frame)

    def until(self, condition: Callable[[], object]) -> None:
        """Go on until something holds."""
        end = time.monotonic() + PATIENCE
        while not condition():
            assert time.monotonic() < end, (self.states, self.notes)
            self.step()
            time.sleep(0.002)

"""A tracker that is shown frames in reverse: `MirroredTracker`."""

from typing import Any, Protocol

import msgspec

from matchset.image.frame import Frame
from matchset.tracking.track import Lost, Track, mirrored


class FrameFollower(Protocol):
    """What tracks a shape from frame to frame, each later than the one before."""

    def update(self, frame: Frame) -> Track[Any] | Lost[Any]:
        """Track the shape into `frame`."""
        ...


class MirroredTracker:
    """Follows a shape backward, from a frame to those before it.

    Its tracker sees time run forward: each frame at its time mirrored at that of the first. Mirrored, the fields of an
    interlaced picture come in the other order, and the time between them, which a tracker learns, has the other sign.
    So it must be a tracker of its own, not one that has followed the same camera forward. The field offset of its
    answers is a distance in the picture and the same both ways.

    Parameters
    ----------
    tracker : FrameFollower
        That has seen no frame.
    """

    def __init__(self, tracker: FrameFollower) -> None:
        self._tracker = tracker
        self._twice: float | None = None  # twice the time at which it is mirrored, s

    def update(self, frame: Frame) -> Track[Any] | Lost[Any]:
        """Track the shape into a frame that is earlier than the one before; the answer has the frame's own time."""
        if self._twice is None:
            self._twice = 2.0 * frame.time
        answer = self._tracker.update(msgspec.structs.replace(frame, time=self._twice - frame.time))
        return mirrored(answer, frame.time, self._twice)

"""A video that plays at its own rate: `PacedVideo`."""

import time

from matchset.image.frame import Frame
from matchset.image.video import Video


class PacedVideo(Video):
    """A video that plays at its own rate; a live source as it comes."""

    _begin: float | None = None

    def __next__(self) -> Frame:
        frame = super().__next__()
        if not self.live:
            if self._begin is None:
                self._begin = time.monotonic() - frame.time
            time.sleep(max(0.0, self._begin + frame.time - time.monotonic()))
        return frame

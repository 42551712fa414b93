"""Large pictures: what is looked for by eye is looked for in a smaller copy (`reduced`, `rescaled`)."""

import cv2
import msgspec
import numpy as np

from matchset.image.candidates import Candidate
from matchset.image.frame import Frame


class LargeFrameParameters(msgspec.Struct, frozen=True):
    """From which size on a picture is reduced before its circles and colors are compared.

    Parameters
    ----------
    longest_px : int
        Longer side to which larger pictures are brought, px. More sees smaller balls in them; time and memory grow with
        its square. Chosen by hand: HD video stays as it is, and `learn` of 7680 x 5760 px takes 12 s, 211 s without.
    """

    longest_px: int = 1920


PARAMETERS = LargeFrameParameters()


def reduced(frame: Frame) -> Frame:
    """Return a frame, or a smaller copy of one that is larger than `LargeFrameParameters.longest_px`."""
    height, width = frame.image.shape[:2]
    scale = PARAMETERS.longest_px / max(height, width)
    if scale >= 1.0:
        return frame
    size = max(round(width * scale), 1), max(round(height * scale), 1)
    image = cv2.resize(frame.image, size, interpolation=cv2.INTER_AREA)
    return Frame(np.asarray(image, np.uint8), frame.time, frame.index)


def rescaled(candidate: Candidate, old: Frame, new: Frame) -> Candidate:
    """Return a candidate of one copy of a frame in the pixels of another copy."""
    if old is new:
        return candidate
    scale = max(new.image.shape[:2]) / max(old.image.shape[:2])
    x, y = ((value + 0.5) * scale - 0.5 for value in (candidate.x, candidate.y))
    column, row = (
        min(max(round((value + 0.5) * scale - 0.5), 0), side - 1)
        for value, side in zip(candidate.pick, new.image.shape[1::-1], strict=True)
    )
    return Candidate(x, y, candidate.radius * scale, (column, row), candidate.score)

"""OpenCV's MOSSE tracker: a correlation filter, the fastest of its box trackers; its box never changes its size."""

import msgspec
from cv2 import legacy  # type: ignore[attr-defined]

from benchmarks.common.box import follow_box
from benchmarks.common.start import Choices, Start, Step

NAME = "MOSSE (its box keeps its size)"
NEEDS = "circle"


class Parameters(msgspec.Struct, frozen=True):
    """Half the side of the box in the first frame, radii."""

    half: float = 1.0


CHOICES: Choices = {"half": (0.8, 1.0, 1.2, 1.5)}


def follow(start: Start, parameters: Parameters) -> Step:
    """Follow the square around the circle of the first frame; what is lost is not searched for."""
    return follow_box(legacy.TrackerMOSSE_create(), start, parameters.half)

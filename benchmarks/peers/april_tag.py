"""AprilTag 3 (pupil-apriltags): corners of a printed 36h11 tag."""

import functools
from typing import Any

import cv2
import msgspec

from benchmarks.common.card import APRIL
from benchmarks.common.start import Choices, Circle3, Image, Start, Step

NAME = "AprilTag 3 (pupil-apriltags)"
NEEDS = "nothing"
CORNER = 0.5  # its coordinates count pixels' corners, ours their middles


class Parameters(msgspec.Struct, frozen=True):
    """Decimation of the picture in which quads are found; sharpening before decoding; blur, px."""

    decimate: float = 2.0
    sharpening: float = 0.25
    blur: float = 0.0


CHOICES: Choices = {"decimate": (1.0, 1.5, 2.0), "blur": (0.0, 0.8), "sharpening": (0.25, 0.5)}


@functools.cache
def detector(parameters: Parameters) -> Any:
    """Make a detector whose memory is never given back: the library crashes when it is."""
    from pupil_apriltags import Detector

    class Kept(Detector):  # type: ignore[misc]
        def __del__(self) -> None:
            pass

    return Kept(
        families="tag36h11",
        nthreads=1,
        quad_decimate=parameters.decimate,
        quad_sigma=parameters.blur,
        decode_sharpening=parameters.sharpening,
    )


def follow(start: Start, parameters: Parameters) -> Step:  # noqa: ARG001
    """Detect in every frame anew; the circle inscribed in the card."""
    tags = detector(parameters)

    def step(image: Image) -> Circle3 | None:
        found = tags.detect(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))
        return APRIL.circle(found[0].corners - CORNER) if found else None

    return step

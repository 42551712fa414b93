"""OpenCV's ArUco: corners of a printed 4 x 4 tag."""

import cv2
import msgspec

from benchmarks.common.card import ARUCO
from benchmarks.common.start import Choices, Circle3, Image, Start, Step

NAME = "ArUco 4 × 4 (OpenCV)"
NEEDS = "nothing"


class Parameters(msgspec.Struct, frozen=True):
    """Refine corners to a fraction of a pixel; half the refinement's window, px."""

    refine: bool = True
    window: int = 5


CHOICES: Choices = {"refine": (True, False), "window": (3, 5)}


def follow(start: Start, parameters: Parameters) -> Step:  # noqa: ARG001
    """Detect in every frame anew; the circle inscribed in the card."""
    settings = cv2.aruco.DetectorParameters()
    if parameters.refine:
        settings.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
        settings.cornerRefinementWinSize = parameters.window
    detector = cv2.aruco.ArucoDetector(cv2.aruco.getPredefinedDictionary(ARUCO.dictionary), settings)

    def step(image: Image) -> Circle3 | None:
        corners, _, _ = detector.detectMarkers(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))
        return ARUCO.circle(corners[0][0]) if len(corners) else None

    return step

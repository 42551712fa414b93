"""Tag systems: AprilTag 3 (pupil-apriltags) and OpenCV's ArUco, on printed cards."""

import functools
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step


class Card(msgspec.Struct, frozen=True):
    """A card with a tag and a white rim around it.

    Parameters
    ----------
    dictionary : int
        OpenCV's number of the tag's family.
    cells : int
        Cells on a side of the black square, its border included; the rim is one cell wide.
    """

    dictionary: int
    cells: int

    def picture(self, pixels: int) -> npt.NDArray[np.uint8]:
        """Draw tag 0 with its rim, gray, about that many pixels wide."""
        cell = max(pixels // (self.cells + 2), 1)
        tag = cv2.aruco.generateImageMarker(
            cv2.aruco.getPredefinedDictionary(self.dictionary), 0, cell * self.cells, borderBits=1
        )
        return np.pad(np.asarray(tag, np.uint8), cell, constant_values=255)

    def circle(self, corners: npt.ArrayLike) -> Circle3:
        """Circle inscribed in the card, from the corners of the black square, (4, 2), px."""
        square = np.asarray(corners, np.float64)
        side = float(np.linalg.norm(square - np.roll(square, 1, axis=0), axis=1).mean())
        x, y = square.mean(axis=0).tolist()
        return x, y, side * (self.cells + 2) / (2.0 * self.cells)


APRIL = Card(cv2.aruco.DICT_APRILTAG_36h11, 8)
ARUCO = Card(cv2.aruco.DICT_4X4_50, 6)
CARDS = {"april_tag": APRIL, "aruco": ARUCO}


CORNER = 0.5  # its coordinates count pixels' corners, ours their middles


class AprilTagParameters(msgspec.Struct, frozen=True):
    """Decimation of the picture in which quads are found; sharpening before decoding; blur, px."""

    decimate: float = 2.0
    sharpening: float = 0.25
    blur: float = 0.0


APRIL_TAG_CHOICES: Choices = {"decimate": (1.0, 1.5, 2.0), "blur": (0.0, 0.8), "sharpening": (0.25, 0.5)}


@functools.cache
def detector(parameters: AprilTagParameters) -> Any:
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


def follow_april_tag(start: Start, parameters: AprilTagParameters) -> Step:  # noqa: ARG001
    """Detect in every frame anew; the circle inscribed in the card."""
    tags = detector(parameters)

    def step(image: Image) -> Circle3 | None:
        found = tags.detect(cv2.cvtColor(image, cv2.COLOR_BGR2GRAY))
        return APRIL.circle(found[0].corners - CORNER) if found else None

    return step


class ArucoParameters(msgspec.Struct, frozen=True):
    """Refine corners to a fraction of a pixel; half the refinement's window, px."""

    refine: bool = True
    window: int = 5


ARUCO_CHOICES: Choices = {"refine": (True, False), "window": (3, 5)}


def follow_aruco(start: Start, parameters: ArucoParameters) -> Step:  # noqa: ARG001
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


PEERS = {
    "april_tag": Method(
        "AprilTag 3 (pupil-apriltags)", "nothing", AprilTagParameters, APRIL_TAG_CHOICES, follow_april_tag
    ),
    "aruco": Method("ArUco 4 × 4 (OpenCV)", "nothing", ArucoParameters, ARUCO_CHOICES, follow_aruco),
}

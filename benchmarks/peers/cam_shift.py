"""OpenCV's CamShift: a histogram of hues from the first frame, projected back, climbed to its middle."""

import cv2
import msgspec
import numpy as np

from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import disc_pixels

UNTIL = (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 10, 1.0)


class Parameters(msgspec.Struct, frozen=True):
    """Least saturation and value of a pixel that counts; bins of the histogram; radius over mean half axis."""

    saturation: int = 90
    value: int = 40
    bins: int = 32
    scale: float = 1.0


CHOICES: Choices = {
    "saturation": (50, 90, 130),
    "value": (30, 60),
    "bins": (16, 32, 60),
    "scale": (0.9, 0.95, 1.0, 1.05),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Climb from the last window; from the whole frame where that is empty."""
    least, most = (0, parameters.saturation, parameters.value), (180, 255, 255)
    disc = cv2.cvtColor(disc_pixels(start)[np.newaxis], cv2.COLOR_BGR2HSV)
    histogram = cv2.calcHist([disc], [0], cv2.inRange(disc, least, most), [parameters.bins], [0, 180])
    cv2.normalize(histogram, histogram, 0, 255, cv2.NORM_MINMAX)
    x, y, r = start.circle
    window = (round(x - r), round(y - r), round(2.0 * r), round(2.0 * r))

    def step(image: Image) -> Circle3 | None:
        nonlocal window
        hsv = cv2.cvtColor(image, cv2.COLOR_BGR2HSV)
        likely = cv2.calcBackProject([hsv], [0], histogram, [0, 180], 1)
        likely = cv2.bitwise_and(likely, cv2.inRange(hsv, least, most))
        if window[2] < 1 or window[3] < 1:
            window = (0, 0, image.shape[1], image.shape[0])
        box, found = cv2.CamShift(likely, window, UNTIL)
        window = (int(found[0]), int(found[1]), int(found[2]), int(found[3]))
        radius = parameters.scale * (box[1][0] + box[1][1]) / 4.0
        return (float(box[0][0]), float(box[0][1]), float(radius)) if radius > 0.5 else None

    return step


PEERS = {
    "cam_shift": Method("CamShift", "circle", Parameters, CHOICES, follow),
}

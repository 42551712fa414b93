"""ViSP's moving-edge ellipse (vpMeEllipse): short searches along the normals of the last ellipse, then a fit."""

import cv2
import msgspec
import numpy as np

from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range
from benchmarks.common.visp import Visp

NAME = "ViSP vpMeEllipse"
NEEDS = "circle"


class Parameters(msgspec.Struct, frozen=True):
    """What it sees, the gray picture or the HSV mask; search range, px; sample step, degrees; contrast; color."""

    mask: bool = True
    range: int = 20
    step: float = 4.0
    threshold: float = 10000.0
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4


CHOICES: Choices = {
    "mask": (True, False),
    "hue": (8, 16, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6),
    "range": (12, 20, 30),
    "step": (4.0, 10.0),
    "threshold": (5000.0, 10000.0, 20000.0),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Begin with eight true points of the rim; what is lost is not searched for."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    visp = Visp(*start.image.shape[:2])

    def show(image: Image) -> None:
        if parameters.mask:
            np.copyto(visp.picture, hsv_mask(image, bounds, 3))
        else:
            cv2.cvtColor(image, cv2.COLOR_BGR2GRAY, dst=visp.picture)

    def step(image: Image) -> Circle3 | None:
        show(image)
        return visp.ask("track")

    show(start.image)
    x, y, r = start.circle
    visp.ask(f"ellipse {x} {y} {r} {parameters.range} {parameters.step} {parameters.threshold}")
    return step

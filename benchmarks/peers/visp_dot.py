"""ViSP's dot tracker (vpDot2) on the HSV mask: the border of a patch, walked around, and its moments."""

import msgspec
import numpy as np

from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range
from benchmarks.common.visp import Visp

NAME = "ViSP vpDot2 on the HSV mask"
NEEDS = "circle"
HALF_PIXEL = 0.5  # its border runs through the middles of the outermost pixels


class Parameters(msgspec.Struct, frozen=True):
    """The color's range, and the opening, px."""

    hue: int = 30
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 5


CHOICES: Choices = {
    "hue": (8, 16, 22, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6),
    "value": (0.1, 0.2, 0.35, 0.5),
    "opening": (0, 3, 5),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Begin half a radius beside the middle, where no marker is; what is lost is looked for where it was."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    visp = Visp(*start.image.shape[:2])

    def step(image: Image) -> Circle3 | None:
        np.copyto(visp.picture, hsv_mask(image, bounds, parameters.opening))
        found = visp.ask("track")
        return None if found is None else (found[0], found[1], found[2] + HALF_PIXEL)

    np.copyto(visp.picture, hsv_mask(start.image, bounds, parameters.opening))
    x, y, r = start.circle
    visp.ask(f"dot {x - 0.5 * r} {y} {r}")
    return step

"""The paper to the letter: Alg. 2 on the first frame, Alg. 3 on the others, in plain NumPy (`matchset.reference`)."""

import msgspec
import numpy as np

from benchmarks.common.contour import COLOR_CHOICES
from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range
from matchset.reference import Search, init_circle, track_circle

AROUND = 4  # px: INITCIRCLE tries the circles this near to the first; all of a frame's would take it hours


class Parameters(msgspec.Struct, frozen=True):
    """Eq. 1's margin, px, and threshold, in shares of it; the color's range; side of the opening, px."""

    margin: int = 3
    threshold: float = 0.7
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 3


CHOICES: Choices = {
    **COLOR_CHOICES,
    "margin": (2, 3, 4, 6),
    "threshold": (0.1, 0.4, 0.7, 0.85),
    "opening": (0, 3, 5),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Follow with the paper's own tracking, which never says that it is lost."""
    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    margin, threshold = parameters.margin, parameters.threshold * parameters.margin
    x, y, radius = (round(value) for value in start.circle)
    near = range(-AROUND, AROUND + 1)
    search = Search([x + d for d in near], [y + d for d in near], [max(radius + d, 1) for d in near])
    found = init_circle(hsv_mask(start.image, bounds, parameters.opening) > 0, margin, threshold, 0.5, search)

    def step(image: Image) -> Circle3 | None:
        nonlocal found
        if found is None:
            return None
        found = track_circle(hsv_mask(image, bounds, parameters.opening) > 0, found[1], found[0], margin, threshold)
        circle = found[0]
        answer = circle.x, circle.y, circle.radius
        return answer if np.isfinite(answer).all() else None

    return step


PEERS = {
    "paper": Method("the paper to the letter (NumPy)", "circle", Parameters, CHOICES, follow),
}

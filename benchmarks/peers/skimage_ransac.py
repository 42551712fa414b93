"""scikit-image: a circle through the mask's contour by RANSAC."""

import msgspec
import numpy as np

from benchmarks.common.contour import HALF_PIXEL, largest
from benchmarks.common.mask import COLOR_CHOICES
from benchmarks.common.start import Choices, Circle3, Image, Start, Step
from benchmarks.common.target_color import hsv_mask, hsv_range

NAME = "scikit-image: RANSAC CircleModel on the contour"
NEEDS = "color"


class Parameters(msgspec.Struct, frozen=True):
    """Residual of an inlier, px; trials; side of the opening, px; the color's range."""

    inlier: float = 1.5
    trials: int = 30
    opening: int = 3
    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4


CHOICES: Choices = {
    **COLOR_CHOICES,
    "inlier": (1.0, 1.5, 2.5),
    "opening": (0, 3),
}


def follow(start: Start, parameters: Parameters) -> Step:
    """Detect in every frame anew."""
    from skimage.measure import CircleModel, ransac

    bounds = hsv_range(start, parameters.hue, parameters.saturation, parameters.value)
    rng = np.random.default_rng(0)

    def step(image: Image) -> Circle3 | None:
        outline = largest(hsv_mask(image, bounds, parameters.opening))
        if outline is None or len(outline) < 8:
            return None
        points = outline[:, 0].astype(np.float64)
        model, _ = ransac(points, CircleModel, 3, parameters.inlier, max_trials=parameters.trials, rng=rng)
        if not model:
            return None
        x, y = model.center
        return float(x), float(y), float(model.radius) + HALF_PIXEL

    return step

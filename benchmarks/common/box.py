"""Box trackers driven: a square around the first circle, and the circle inside the box they answer."""

from typing import Any

from benchmarks.common.start import Circle3, Image, Start, Step


def follow_box(tracker: Any, start: Start, half: float, scales: bool = False) -> Step:
    """Start a box tracker.

    Parameters
    ----------
    tracker : object
        OpenCV's: with `init` and `update`.
    start : Start
    half : float
        Half the side of the box, radii.
    scales : bool, optional
        Whether the box changes its size with what is followed; by default it does not. Such a box is rounded to a size
        that suits a Fourier transform, which says nothing of the radius: that stays what it was.

    Returns
    -------
    callable
    """
    x, y, r = start.circle
    side = round(2.0 * half * r)
    tracker.init(start.image, (round(x - half * r), round(y - half * r), side, side))

    def step(image: Image) -> Circle3 | None:
        held, (left, top, width, height) = tracker.update(image)
        if not held or width <= 0 or height <= 0:
            return None
        # Pixels left ... left + width - 1: their middle lies half a pixel before left + width / 2.
        radius = (width + height) / 4.0 / half if scales else r
        return left + width / 2.0 - 0.5, top + height / 2.0 - 0.5, radius

    return step

"""matchset with default settings, from one click."""

import msgspec

import matchset as ms
from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step


class Parameters(msgspec.Struct, frozen=True):
    """None: the defaults."""


CHOICES: Choices = {}


def follow(start: Start, parameters: Parameters) -> Step:  # noqa: ARG001
    """Click half a radius beside the middle of the first frame's disc; nothing else is taken from the truth."""
    click = start.circle[0] - 0.5 * start.circle[2], start.circle[1]
    color = ms.ColorModel.pick(start.image, *click)
    tracker = ms.Tracker(ms.Circle, color, start=click if start.here else None)
    if start.here:
        tracker.update(ms.Frame(start.image, 0.0, 0))
    index = 0

    def step(image: Image) -> Circle3 | None:
        nonlocal index
        index += 1
        answer = tracker.update(ms.Frame(image, index / start.fps, index))
        if isinstance(answer, ms.Lost):
            return None
        shape = answer.shape
        return shape.x, shape.y, shape.radius

    return step


PEERS = {
    "matchset": Method("matchset", "color", Parameters, CHOICES, follow),
}

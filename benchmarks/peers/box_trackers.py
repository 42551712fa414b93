"""OpenCV's box trackers: correlation filters, begun with a square around the first circle."""

from typing import Any

import msgspec
from cv2 import legacy  # type: ignore[attr-defined]

from benchmarks.common.start import Choices, Circle3, Image, Method, Start, Step


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


class MosseParameters(msgspec.Struct, frozen=True):
    """Half the side of the box in the first frame, radii."""

    half: float = 1.0


MOSSE_CHOICES: Choices = {"half": (0.8, 1.0, 1.2, 1.5)}


def follow_mosse(start: Start, parameters: MosseParameters) -> Step:
    """Follow the square around the circle of the first frame; what is lost is not searched for."""
    return follow_box(legacy.TrackerMOSSE_create(), start, parameters.half)


class KcfParameters(msgspec.Struct, frozen=True):
    """Half the side of the box in the first frame, radii."""

    half: float = 1.0


KCF_CHOICES: Choices = {"half": (0.8, 1.0, 1.2, 1.5)}


def follow_kcf(start: Start, parameters: KcfParameters) -> Step:
    """Follow the square around the circle of the first frame; what is lost is not searched for."""
    return follow_box(legacy.TrackerKCF_create(), start, parameters.half)


class CsrtParameters(msgspec.Struct, frozen=True):
    """Half the side of the box in the first frame, radii."""

    half: float = 1.0


CSRT_CHOICES: Choices = {"half": (0.8, 1.0, 1.2, 1.5)}


def follow_csrt(start: Start, parameters: CsrtParameters) -> Step:
    """Follow the square around the circle of the first frame; what is lost is not searched for."""
    return follow_box(legacy.TrackerCSRT_create(), start, parameters.half, scales=True)


PEERS = {
    "mosse": Method("MOSSE (its box keeps its size)", "circle", MosseParameters, MOSSE_CHOICES, follow_mosse),
    "kcf": Method("KCF (its box keeps its size)", "circle", KcfParameters, KCF_CHOICES, follow_kcf),
    "csrt": Method("CSRT", "circle", CsrtParameters, CSRT_CHOICES, follow_csrt),
}

"""Where to begin when somebody said roughly where a shape is: there, or at what stands out there."""

from collections.abc import Iterator
from typing import TypeVar

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.brightness import level_in
from matchset.image.color import ColorModel
from matchset.shapes.shape import Shape, from_hull, outline
from matchset.tracking.look import Look
from matchset.tracking.matcher import Matcher
from matchset.tracking.memory import AGREEMENT, CONFIRMED, SEEN

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

CLEAR = 0.6  # agreement from which a fit is taken to be the shape
SURE = 0.9  # agreement from which the shape that was said needs no second thought
AROUND = 0.3  # how far beyond the shape that was said the picture is looked at, in its width and height
FEW = 16  # pixels that are enough to part them in two
LEAST = 0.2  # share of the box that a region must fill to be what was meant


def begin_near(image: Image, color: ColorModel, matcher: Matcher[S], said: S) -> tuple[Floats, float]:
    """State to begin at: of the shape that was said and of the regions there, the one whose fit is best.

    With it comes how far from there the shape may be, px.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    matcher : Matcher
        Fits them.
    said : Shape
        Where the shape is, roughly.
    """
    best, most = said.state, 0.0
    for state in _starts(image, color, said):
        reach = max(4.0, 0.12 * float(type(said).half_width(state)))
        if not matcher.settle(image, color, state, Look(reach)):
            continue
        merit = matcher.fit(AGREEMENT) * matcher.fit(SEEN) / matcher.points
        if merit > most and matcher.fit(CONFIRMED) > 0.0 and _about(matcher.state, said):
            best, most = matcher.alike(matcher.state.copy()), merit
        if most > SURE:
            break
    return best, 1.0 if most > CLEAR else 3.0 + 0.1 * float(type(said).half_width(best))


def _starts(image: Image, color: ColorModel, said: S) -> Iterator[Floats]:
    """States to try: that which was said, then what the regions of the color in its box may be."""
    yield said.state
    points = outline(said)
    low, high = points.min(axis=0), points.max(axis=0)
    room = AROUND * (high - low) + 2.0
    left, top = np.maximum(np.floor(low - room), 0).astype(int).tolist()
    right, bottom = np.minimum(np.ceil(high + room) + 1, image.shape[1::-1]).astype(int).tolist()
    if right - left < 4 or bottom - top < 4:
        return
    part = np.ascontiguousarray(image[top:bottom, left:right])
    for mask in _masks(part, color):
        for hull in _regions(mask, LEAST * float(np.prod(high - low))):
            for shape in from_hull(type(said), hull + np.array((left, top))):
                yield shape.state


def _masks(part: Image, color: ColorModel) -> Iterator[Image]:
    """Where a part of a picture looks like the target; of dark and light things also what is so among its like."""
    if not color.gray:
        yield color.mask(part)
        return
    gray = np.asarray(cv2.cvtColor(part, cv2.COLOR_BGR2GRAY) if part.shape[2] == 3 else part[:, :, 0], np.uint8)
    level = level_in(gray)
    for kind in ("dark", "light") if color.gray == "edges" else (color.gray,):
        alike = gray[gray < level] if kind == "dark" else gray[gray >= level]
        levels = [level, level_in(alike[:, np.newaxis])] if len(alike) > FEW else [level]
        for each in levels:
            yield np.asarray(((gray < each) == (kind == "dark")) * np.uint8(255), np.uint8)


def _regions(mask: Image, least: float) -> list[Floats]:
    """Hulls of the regions of a mask that are large enough, largest first, px."""
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    hulls = [cv2.convexHull(contour)[:, 0].astype(np.float64) for contour in contours if len(contour) > 3]
    sized = [(float(cv2.contourArea(hull.astype(np.float32))), hull) for hull in hulls]
    found = sorted((pair for pair in sized if pair[0] >= max(least, 4.0)), key=lambda pair: -pair[0])
    return [hull if _turns_right(hull) else np.ascontiguousarray(hull[::-1]) for _, hull in found[:3]]


def _turns_right(hull: Floats) -> bool:
    x, y = hull[:, 0], hull[:, 1]
    return bool((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0.0)


def _about(state: Floats, said: S) -> bool:
    """Whether a state is about where and as large as what was said."""
    family = type(said)
    size, other = float(family.half_width(said.state)), float(family.half_width(state))
    far = float(np.hypot(*(state[:2] - said.state[:2])))
    return far < 0.7 * size and 0.5 * size < other < 1.7 * size

"""Initialization where somebody said roughly where a shape is: there, or at what stands out there."""

import math
import warnings
from collections.abc import Iterator
from typing import TypeVar

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Fitter
from matchset.fitting.match_set import SECOND_DIFFERENCE
from matchset.fitting.workspace import SearchWindow
from matchset.image.brightness import DEFAULT, BrightnessParameters, as_gray, level_across, level_in
from matchset.image.color import ColorModel
from matchset.shapes.shape import Shape, from_hull, nearest, outline

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

EXCHANGED = "blue and red seem to be exchanged: pictures are BGR, image[..., ::-1] makes them of RGB"  # format: words


class InitializationParameters(msgspec.Struct, frozen=True):
    """How tracking begins at a shape that was given roughly.

    All numbers chosen by hand; `tests/image` (dark and light things) and `python -m benchmarks --only shapes` would
    show a change.

    Parameters
    ----------
    sigma_px, sigma_share : float
        How far from a given shape the first sighting may be: px, plus a share of its half-width.
    sure_sigma : float
        The same once a clear fit was found there, px.
    detected_share : float
        The same after a detection, in half-widths.
    clear_score, sure_score : float
        Rank from which a fit is taken to be the shape, and from which no other is tried.
    range_px, range_share : float
        Search range of such a fit: at least px, or a share of the half-width.
    around, around_px : float
        How far beyond the given shape the picture is looked at, in its width and height, plus px.
    min_pixels : int
        Pixels from which on gray levels are split in two once more.
    box_share, min_area : float
        Least area of a region, as a share of the given shape's box, and in px^2.
    regions : int
        How many regions are tried, largest first.
    near, shrink, growth : float
        How far from the given shape's center a fit may be, in half-widths, and by which factors its size may differ.
    """

    sigma_px: float = 3.0
    sigma_share: float = 0.1
    sure_sigma: float = 1.0
    detected_share: float = 0.25
    clear_score: float = 0.6
    sure_score: float = 0.9
    range_px: float = 4.0
    range_share: float = 0.12
    around: float = 0.3
    around_px: float = 2.0
    min_pixels: int = 16
    box_share: float = 0.2
    min_area: float = 4.0
    regions: int = 3
    near: float = 0.7
    shrink: float = 0.5
    growth: float = 1.7


def noise_in(image: Image, box: tuple[float, float, float, float], limits: InitializationParameters) -> float:
    """Measure the noise of the pixels around a box, gray levels: from second differences along the rows.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    box : tuple of four floats
        Left, top, right, bottom, px.
    limits : InitializationParameters
    """
    (left, top, right, bottom), margin = box, limits.around_px
    across, down = limits.around * (right - left) + margin, limits.around * (bottom - top) + margin
    rows = slice(max(round(top - down), 0), max(round(bottom + down) + 1, 0))
    columns = slice(max(round(left - across), 0), max(round(right + across) + 1, 0))
    pixels = image[rows, columns, 1 if image.shape[2] > 1 else 0].astype(np.int16)
    if pixels.shape[0] < 1 or pixels.shape[1] <= 2:
        return 0.0
    return float(np.abs(np.diff(pixels, 2, axis=1)).mean()) / SECOND_DIFFERENCE


def check_start(image: Image, color: ColorModel, start: tuple[float, float] | None) -> None:
    """Check the picture in which a search begins at a point: whether that is in it, and what its color is there.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3) or (h, w), uint8
    color : ColorModel
        That of the target.
    start : tuple of 2 floats or None
        The point, px; None: no check.

    Raises
    ------
    ValueError
        If the point is outside of the picture.

    Warns
    -----
    UserWarning
        If the pixels around the point would have the target's color with blue and red exchanged, and do not have it.
    """
    if start is None:
        return
    (x, y), (height, width) = start, image.shape[:2]
    if not (-0.5 <= x < width - 0.5 and -0.5 <= y < height - 0.5):
        raise ValueError(f"start {start} does not lie in the {width} x {height} picture")
    if color.gray or color.channels != 3:
        return
    row, column = round(y), round(x)
    around = image[max(row - 1, 0) : row + 2, max(column - 1, 0) : column + 2]
    if (color.scores(around) <= 0).all() and (color.scores(around[..., ::-1]) > 0).all():
        warnings.warn(f"at the start {start} {EXCHANGED}", stacklevel=4)


def initialize_near(
    image: Image,
    color: ColorModel,
    fitter: Fitter[S],
    given: S,
    limits: InitializationParameters,
    brightness: BrightnessParameters = DEFAULT,
) -> tuple[Floats, float]:
    """State to begin at: of the given shape and of the regions there, the one whose fit is best.

    With it comes how far from there the shape may be, px.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    fitter : Fitter
        Fits them.
    given : Shape
        Where the shape is, roughly.
    limits : InitializationParameters
    brightness : BrightnessParameters
    """
    best, most = given.state, 0.0
    last = fitter.work.motion.last_state[: len(best)]
    for state in _starts(image, color, given, limits, brightness):
        reach = max(limits.range_px, limits.range_share * float(fitter.family.half_width(state)))
        estimate = fitter.fit(image, color, state, SearchWindow(reach))
        if not estimate.is_fitted:
            continue
        score = estimate.fit.msac_score * estimate.fit.visible / fitter.points
        if score > most and estimate.fit.inliers > 0 and _is_near(estimate.state, given, limits):
            best, most = nearest(fitter.family, estimate.state, last), score
        if most > limits.sure_score:
            break
    size = float(fitter.family.half_width(best))
    return best, limits.sure_sigma if most > limits.clear_score else limits.sigma_px + limits.sigma_share * size


def _starts(
    image: Image, color: ColorModel, given: S, limits: InitializationParameters, brightness: BrightnessParameters
) -> Iterator[Floats]:
    """States to try: that which was given, then what the regions of the color in its box may be."""
    yield given.state
    points = outline(given)
    low, high = points.min(axis=0), points.max(axis=0)
    room = limits.around * (high - low) + limits.around_px
    left, top = np.maximum(np.floor(low - room), 0).astype(int).tolist()
    right, bottom = np.minimum(np.ceil(high + room) + 1, image.shape[1::-1]).astype(int).tolist()
    if right - left < 4 or bottom - top < 4:
        return
    part = np.ascontiguousarray(image[top:bottom, left:right])
    for mask in _masks(part, color, limits.min_pixels, brightness):
        for hull in _regions(mask, limits.box_share * float(np.prod(high - low)), limits):
            for shape in from_hull(type(given), hull + np.array((left, top))):
                yield shape.state


def _masks(part: Image, color: ColorModel, min_pixels: int, brightness: BrightnessParameters) -> Iterator[Image]:
    """Where a part of a picture looks like the target; of dark and light things also what is so among its like."""
    if not color.gray:
        yield color.mask(part)
        return
    gray = as_gray(part)
    level = level_in(gray, brightness)
    for kind in ("dark", "light") if color.gray == "edges" else (color.gray,):
        alike = gray[gray < level] if kind == "dark" else gray[gray >= level]
        levels = [level, level_in(alike[:, np.newaxis], brightness)] if len(alike) > min_pixels else [level]
        for each in levels:
            yield np.asarray(((gray < each) == (kind == "dark")) * np.uint8(255), np.uint8)


def _regions(mask: Image, least: float, limits: InitializationParameters) -> list[Floats]:
    """Hulls of the regions of a mask that are large enough, largest first, px."""
    contours, _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_SIMPLE)
    hulls = [cv2.convexHull(contour)[:, 0].astype(np.float64) for contour in contours if len(contour) > 3]
    sized = [(float(cv2.contourArea(hull.astype(np.float32))), hull) for hull in hulls]
    found = sorted((pair for pair in sized if pair[0] >= max(least, limits.min_area)), key=lambda pair: -pair[0])
    return [hull if _turns_right(hull) else np.ascontiguousarray(hull[::-1]) for _, hull in found[: limits.regions]]


def _turns_right(hull: Floats) -> bool:
    x, y = hull[:, 0], hull[:, 1]
    return bool((x * np.roll(y, -1) - y * np.roll(x, -1)).sum() > 0.0)


def _is_near(state: Floats, given: S, limits: InitializationParameters) -> bool:
    """Whether a state is about where and as large as what was given."""
    family = type(given)
    size, other = float(family.half_width(given.state)), float(family.half_width(state))
    far = float(np.hypot(*(state[:2] - given.state[:2])))
    return far < limits.near * size and limits.shrink * size < other < limits.growth * size


def model_for_image(
    color: ColorModel, image: Image, shape: Shape | None, parameters: BrightnessParameters
) -> ColorModel:
    """Brightness model with the level of the picture, or that of the edge of a shape in it."""
    if shape is None:
        return color.for_image(image, None, parameters)
    x, y = shape.state[:2].tolist()
    level = level_across(image, outline(shape), x, y, parameters)
    return color.for_image(image, None if math.isnan(level) else level, parameters)

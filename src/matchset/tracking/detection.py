"""Detection in one picture that somebody asks for: `detect`, and which fit of a ball that was clicked is the ball."""

import itertools
import math
import threading
from collections.abc import Iterator
from typing import Any, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Estimate
from matchset.fitting.validation import Prior
from matchset.fitting.workspace import SearchWindow
from matchset.image.circle_score import CircleTuple
from matchset.image.color import ColorModel
from matchset.image.frame import Picture, frame_of
from matchset.numeric.arguments import check_kind, checked_count
from matchset.shapes.circle import Circle
from matchset.shapes.shape import Shape
from matchset.tracking.ball.disc_detector import DiscDetector, DiscDetectorParameters
from matchset.tracking.ball.likely_circle import LikelyCircle, LikelyParameters, circle_of
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import DETECTION_LINES, DetectionParameters, Detector, Start, channels_last, track_of
from matchset.tracking.search.voting import Searcher, SearchParameters, stride_for
from matchset.tracking.track import Track

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
MOST_SHAPES = 1_000_000  # format: that a call can be asked for


class ChoiceParameters(msgspec.Struct, frozen=True):
    """Which fits are compared where a first answer is not sure, or there is none.

    Chosen by hand; `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    sure_evidence, sure_msac : float
        Log-odds and MSAC score from which on a detection is right as it is.
    blobs : int
        How many places that have more of the color than what is around them are looked at.
    least_px, largest : float
        Least radius of a fit, px, and the largest as a share of the longer side of the picture.
    least_core : float
        Least mean whiteness in the middle of a fit that is compared.
    same_place, same_px, same_size : float
        Fits are the same within this distance of center, in radii plus px, and of ln(radius).
    discs : DiscDetectorParameters
        How the network of discs is asked first.
    likely : LikelyParameters
        How they are compared.
    """

    sure_evidence: float = 7.0
    sure_msac: float = 0.85
    blobs: int = 8
    least_px: float = 1.5
    largest: float = 0.6
    same_place: float = 0.03
    same_px: float = 0.25
    same_size: float = 0.04
    discs: DiscDetectorParameters = DiscDetectorParameters()
    likely: LikelyParameters = LikelyParameters()


CHOICE = ChoiceParameters()


def detect(frame: Picture, family: type[S], color: ColorModel, limit: int = 10) -> list[Track[S]]:
    """Find all shapes of a family and color in a frame, without knowing where they were.

    Parameters
    ----------
    frame : Frame, or ndarray of shape (h, w, 3) or (h, w), uint8
        An array counts as taken at 0 s.
    family : type
        The family of shapes: `Circle`, `Rectangle`, ...
    color : ColorModel
    limit : int
        How many at most.

    Returns
    -------
    list of Track
        Best first: the largest share of outline and inside confirmed.

    Raises
    ------
    ValueError
        If the limit is no whole number from 1 to 1000000, or the color was learned on another kind of picture.
    TypeError
        If it is neither a frame nor an array, or no `ColorModel`.
    """
    frame = frame_of(frame)
    check_kind("color", color, ColorModel, "ColorModel.pick(image, x, y) learns one from a click")
    limit = checked_count("limit", limit, 1, MOST_SHAPES)
    image, color = channels_last(frame.image), color.for_image(frame.image)
    search = SearchParameters()
    detector = _detector(
        family, image.shape[1], image.shape[0], max(search.candidates, limit + limit // 5), _radius_of(color)
    )
    last: S | None = None
    found: list[tuple[float, Track[S]]] = []
    sure = False
    for estimate, merit in detector.detections(image, color, Prior.ASKED):
        track = track_of(detector.fitter, last, frame.time)
        last = track.shape
        sure = _is_sure(estimate) if merit > max((pair[0] for pair in found), default=0.0) else sure
        found.append((merit, track))
    found.sort(key=lambda pair: -pair[0])
    if not sure and family is Circle and color.sample is not None and detector.fitter.weighs(color):
        spread = DiscDetector(detector.fitter, color, CHOICE.discs).find(image)
        if spread is not None:
            best = track_of(detector.fitter, None, frame.time, spread)
            found = [(1.0, best), *(each for each in found if not _is_around(best, each[1]))]
        else:
            first = circle_of(found[0][1].shape.state) if found else None
            spread = _Likeliest(detector, image, color).search(first)
            if spread is not None:
                found[:1] = [(1.0, track_of(detector.fitter, None, frame.time, spread))]
    return [track for _, track in found[:limit]]


def _is_around(circle: Track[Any], other: Track[Any]) -> bool:
    """Whether a circle holds another shape's center."""
    x, y, radius = circle_of(circle.shape.state)
    return math.dist(circle_of(other.shape.state)[:2], (x, y)) < radius


def _is_sure(estimate: Estimate) -> bool:
    """Whether nothing else needs to be compared with a detection."""
    return (estimate.evidence or 0.0) > CHOICE.sure_evidence and estimate.fit.msac_score > CHOICE.sure_msac


class _Likeliest:
    """Search of a picture for the likeliest of all fits at all candidates.

    Parameters
    ----------
    detector : Detector
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
        With what was around the circle at the click.
    """

    def __init__(self, detector: Detector[Any], image: Image, color: ColorModel) -> None:
        self._detector, self._image, self._color = detector, image, color
        self._likely = LikelyCircle(color, CHOICE.likely)

    def search(self, first: CircleTuple | None) -> Floats | None:
        """Find the ball, and leave the workspace as its likeliest fit made it, with the mean of the likely ones.

        Parameters
        ----------
        first : (x, y, radius) or None
            Where a detection is; None where nothing was detected.

        Returns
        -------
        ndarray of shape (3, 3) or None
            Covariance between the likely fits, px^2; None if no fit is the ball, or none at the detection was compared.
        """
        fitter, found, most, block = self._detector.fitter, list[tuple[float, CircleTuple]](), -math.inf, None
        for ratio, circle in self._ratios(first):
            if first is not None and not self._likely.is_same(circle, first):
                continue
            found.append((ratio, circle))
            if ratio > most:
                most, block = ratio, fitter.block.copy()
        if block is None or (first is None and not self._likely.is_there(found)):
            return None
        fitter.block[:] = block
        fitter.state[:3], spread = self._likely.mean(found)
        return spread

    def _ratios(self, first: CircleTuple | None) -> Iterator[tuple[float, CircleTuple]]:
        """Fits that are compared: log-likelihood ratio and circle; the workspace is as each made it."""
        fitter, image, color = self._detector.fitter, self._image, self._color
        seen: set[tuple[int, int, int]] = set()
        for estimate in self._fits(first):
            circle = circle_of(estimate.state)
            if not estimate.is_fitted or not self._is_in_range(circle) or (key := _cell_of(circle)) in seen:
                continue
            seen.add(key)
            weighed = fitter.weigh(estimate, image, color)
            figures = self._likely.figures(image, weighed, fitter.near_step(weighed, image, color))
            if figures is not None:
                yield self._likely.ratio(figures), circle

    def _fits(self, first: CircleTuple | None) -> Iterator[Estimate]:
        """Fits at the candidates: within a wide range, and near where each begins."""
        detector, fitter, limits = self._detector, self._detector.fitter, self._detector.limits
        for x, y, radius in self._places():
            if radius < CHOICE.least_px or (first is not None and not self._likely.is_near((x, y, radius), first)):
                continue
            start = Start(x, y, radius, Circle(x, y, radius).state)
            reach = max(limits.range_cells * detector.searcher.stride, limits.range_share * radius)
            fitter.forget()
            window = SearchWindow(reach, min_score=limits.min_score)
            yield fitter.fit(self._image, self._color, start.state, window)
            fitter.forget()
            yield from detector.near_fits(self._image, self._color, start)

    def _places(self) -> Iterator[CircleTuple]:
        """Where fits begin: circles that the boundary votes for, and discs in which the color prevails."""
        searcher = self._detector.searcher
        votes = searcher.candidates(self._image, self._color)
        blobs = searcher.blobs(self._image, self._color)[: CHOICE.blobs]
        for x, y, radius, _ in itertools.chain(votes.tolist(), *(each.tolist() for each in blobs)):
            yield x, y, radius

    def _is_in_range(self, circle: CircleTuple) -> bool:
        """Whether a fit may be a ball: in the picture, and neither too small nor too large."""
        (x, y, radius), (height, width) = circle, (self._image.shape[0], self._image.shape[1])
        inside = -radius < x < width + radius and -radius < y < height + radius
        return bool(inside and CHOICE.least_px < radius < CHOICE.largest * max(height, width))


def _cell_of(circle: CircleTuple) -> tuple[int, int, int]:
    """Say which cell nearly equal circles share."""
    x, y, radius = circle
    side = CHOICE.same_place * radius + CHOICE.same_px
    return round(x / side), round(y / side), round(math.log(radius) / CHOICE.same_size)


class _Memory(threading.local):
    """The detector that a thread used last: its working memory takes longer to make than a search takes."""

    detector: Detector[Any] | None = None
    wanted: tuple[Any, ...] = ()


_memory = _Memory()


def _radius_of(color: ColorModel) -> float:
    """Least radius to expect of what a color was picked at, px: half of that seen there."""
    return math.inf if color.sample is None else DetectionParameters().smaller * color.sample.radius


def _detector(family: type[S], width: int, height: int, candidates: int, radius: float) -> Detector[S]:
    """Detector of this thread."""
    search = SearchParameters(candidates=candidates)
    detector, wanted = _memory.detector, (family, width, height, candidates, stride_for(width, search, radius))
    if detector is None or _memory.wanted != wanted:
        searcher = Searcher(width, height, search, radius)
        detector = _memory.detector = Detector(tracking_fitter(family, DETECTION_LINES), searcher)
        _memory.wanted = wanted
    detector.searcher.radius = radius
    detector.fitter.forget()
    return detector

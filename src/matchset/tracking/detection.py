"""Detection in one picture that somebody asks for: `detect`."""

import itertools
import math
import threading
from typing import Any, TypeVar

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.validation import Prior
from matchset.image.color import ColorModel
from matchset.image.disc_network.patch_format import Circle3
from matchset.image.frame import Frame, Picture, channels_last, frame_of
from matchset.numeric.arguments import check_kind, checked_count
from matchset.shapes.circle import Circle
from matchset.shapes.shape import Shape
from matchset.tracking.ball.disc_detector import DiscDetector, DiscDetectorParameters
from matchset.tracking.ball.equal_discs import EqualDiscs, EqualDiscsParameters
from matchset.tracking.ball.log_odds import probability_of
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import DETECTION_LINES, DetectionParameters, Detector, track_of
from matchset.tracking.search.voting import Searcher, SearchParameters, stride_for
from matchset.tracking.track import Track

S = TypeVar("S", bound=Shape)
Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
MOST_SHAPES = 1_000_000  # format: that a call can be asked for


class ChoiceParameters(msgspec.Struct, frozen=True):
    """When the network is asked for a ball in one picture.

    Chosen by hand; `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    sure_evidence, sure_msac : float
        Log-odds and MSAC score from which on a detection is right as it is.
    discs : DiscDetectorParameters
        How the network of discs is asked.
    equal : EqualDiscsParameters
        How those are found that are like others, where several are asked for.
    """

    sure_evidence: float = 7.0
    sure_msac: float = 0.85
    discs: DiscDetectorParameters = DiscDetectorParameters()
    equal: EqualDiscsParameters = EqualDiscsParameters()


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
    detector.fitter.take_rows(frame.rows)
    last: S | None = None
    found: list[tuple[float, Track[S]]] = []
    sure = False
    for estimate, merit in detector.detections(image, color, Prior.ASKED):
        track = track_of(detector.fitter, last, frame.time, pixel_aspect=frame.pixel_aspect)
        last = track.shape
        sure = _is_sure(estimate) if merit > max((pair[0] for pair in found), default=0.0) else sure
        found.append((merit, track))
    found.sort(key=lambda pair: -pair[0])
    if family is not Circle or color.sample is None:
        return [track for _, track in found[:limit]]
    weighs = detector.fitter.weighs(color)
    if not sure and weighs:
        found = _by_network(detector.fitter, color, frame, found, limit)
    if limit > 1:
        found = _with_equal(detector.fitter, color, frame, found, limit)
    return [track for _, track in found[:limit]]


def _by_network(
    fitter: Fitter[Any], color: ColorModel, frame: Frame, outlines: list[tuple[float, Track[Any]]], limit: int
) -> list[tuple[float, Track[Any]]]:
    """Balls that the network sees, with the likeliest first, and their probability; outlines propose places."""
    places = [_circle(track) for _, track in outlines]
    found = list[tuple[float, Track[Any]]]()
    limits = msgspec.structs.replace(CHOICE.discs, compared=max(CHOICE.discs.compared, limit + limit // 5))
    for odds, spread in DiscDetector(fitter, color, limits).find(channels_last(frame.image), places):
        track = track_of(fitter, None, frame.time, spread, pixel_aspect=frame.pixel_aspect)
        found.append((probability_of(odds), track))
    return found


def _with_equal(
    fitter: Fitter[Any], color: ColorModel, frame: Frame, found: list[tuple[float, Track[Any]]], limit: int
) -> list[tuple[float, Track[Any]]]:
    """Balls that were found, and all that are like them, with the likeliest first, and their probability."""
    equal = EqualDiscs(fitter, color, channels_last(frame.image), CHOICE.equal)
    alike = equal.alike([_circle(track) for _, track in found])
    found = [found[number] for number in alike][:limit]
    for merit, track in found:
        equal.know(_circle(track), merit)
    for odds, spread in itertools.chain(equal.clicked(), equal.find(limit)):
        track = track_of(fitter, None, frame.time, spread, pixel_aspect=frame.pixel_aspect)
        found.append((probability_of(odds), track))
    return sorted(found, key=lambda pair: -pair[0])


def _circle(track: Track[Any]) -> Circle3:
    x, y, radius = track.shape.state[:3].tolist()
    return x, y, radius


def _is_sure(estimate: Estimate) -> bool:
    """Whether nothing else needs to be compared with a detection."""
    return (estimate.evidence or 0.0) > CHOICE.sure_evidence and estimate.fit.msac_score > CHOICE.sure_msac


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

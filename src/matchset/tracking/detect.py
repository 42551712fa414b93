"""First sight: from the whole frame to shapes, best first (Epstein & Feldman, Alg. 2)."""

import math
import threading
from collections.abc import Iterator
from typing import Any, Generic, TypeVar

import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.frame import Frame
from matchset.shapes.shape import Shape, finds_itself, from_hull
from matchset.tracking.doubt import drawn_out
from matchset.tracking.judge import Judge, Prior
from matchset.tracking.look import Look
from matchset.tracking.matcher import Matcher
from matchset.tracking.track import Track
from matchset.tracking.voting import Searcher, SearchParameters

S = TypeVar("S", bound=Shape)
HOPELESS = 0.25  # agreement below which a candidate is given up at once
MOVING = 8.0  # px per frame that a shape may move at first sight
Floats = npt.NDArray[np.float64]
Start = tuple[float, float, float, Floats]


class Finder(Generic[S]):
    """Search of one picture size for one family: candidates, fitted and judged.

    Parameters
    ----------
    matcher : Matcher
        Fits the candidates.
    judge : Judge
        Says which of them are confirmed.
    searcher : Searcher
    """

    def __init__(self, matcher: Matcher[S], judge: Judge, searcher: Searcher) -> None:
        self.matcher, self.judge, self.searcher = matcher, judge, searcher

    def sightings(
        self, image: npt.NDArray[np.uint8], color: ColorModel, prior: Prior = Prior.NONE
    ) -> Iterator[tuple[Floats, float]]:
        """Yield the confirmed shapes of a picture, likeliest first: state and merit; the matcher holds the rest.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        prior : Prior
            What is known of them before.
        """
        seen: list[tuple[float, float, float]] = []
        for starts in self._starts(image, color):
            best, most = None, 0.0
            for x, y, radius, start in starts:
                if _covered(seen, x, y, radius):
                    continue
                reach = max(2.0 * self.searcher.stride, 0.2 * radius)
                if not self.matcher.settle(image, color, start, Look(reach, least=HOPELESS)):
                    continue
                if self._covered(seen) or self._refuted(image, color, prior) or self._covered(seen):
                    continue
                merit = self.judge.merit(self.matcher)
                if best is None or merit > most:
                    best, most = self.matcher.state.copy(), merit
            if best is None:
                continue
            if len(starts) > 1:
                self.matcher.settle(image, color, best, Look(4.0))
            seen.append((float(best[0]), float(best[1]), self.matcher.size))
            yield self.matcher.state.copy(), most

    def _starts(self, image: npt.NDArray[np.uint8], color: ColorModel) -> Iterator[list[Start]]:
        """Where fits may begin: for each candidate one or several of x, y, half-width and state."""
        family = self.matcher.family
        for sought in color.search_models(image):
            if finds_itself(family):
                for hull in self.searcher.hulls(image, sought):
                    states = [shape.state for shape in from_hull(family, hull)]
                    yield [(float(s[0]), float(s[1]), float(family.half_width(s)), s) for s in states]
                continue
            for x, y, radius, _ in self.searcher.candidates(image, sought).tolist():
                yield [(x, y, radius, family.from_coarse(x, y, radius).state)]

    def _covered(self, seen: list[tuple[float, float, float]]) -> bool:
        """Whether the shape that was fitted is one that was seen already."""
        return _covered(seen, float(self.matcher.state[0]), float(self.matcher.state[1]), self.matcher.size)

    def _refuted(self, image: npt.NDArray[np.uint8], color: ColorModel, prior: Prior) -> str:
        """Judge the shape that was fitted: why it is none, empty if it is one.

        A second look lets the two fields of an interlaced picture disagree, as they do where it moves; a third one
        begins with the outline drawn out, as a lens may draw it.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        prior : Prior
            What is known of it before.
        """
        reason = self.judge.first_sight(self.matcher, prior)
        if reason and self.matcher.settle(image, color, self.matcher.state.copy(), Look(4.0, MOVING, blind=True)):
            reason = self.judge.first_sight(self.matcher, prior)
        start = drawn_out(self.matcher) if reason else None
        if start is None:
            return reason
        known = self.matcher.parts.fit.copy()
        self.matcher.trust_modes()
        if self.matcher.settle(image, color, start, Look(5.0)) and not self.judge.first_sight(self.matcher, prior):
            return ""
        self.matcher.parts.fit[:] = known  # what was found in vain is not remembered
        return reason


def _covered(seen: list[tuple[float, float, float]], x: float, y: float, size: float) -> bool:
    """Whether this is one of the shapes already seen."""
    return any(math.hypot(x - sx, y - sy) < 0.5 * min(size, ss) and 0.6 < size / ss < 1.7 for sx, sy, ss in seen)


def detect(frame: Frame, family: type[S], color: ColorModel, limit: int = 10) -> list[Track[S]]:
    """Find all shapes of a family and color in a frame, without knowing where they were.

    Parameters
    ----------
    frame : Frame
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
        If the limit is not positive, or the color was learned on another kind of picture.
    """
    if limit < 1:
        raise ValueError(f"detect needs a limit of at least 1, got {limit}")
    image, color = channels_last(frame.image), color.for_image(frame.image)
    finder = _finder(family, image.shape[1], image.shape[0], max(SearchParameters().candidates, limit + limit // 5))
    found = [(merit, finder.matcher.track(frame.time)) for _, merit in finder.sightings(image, color)]
    found.sort(key=lambda pair: -pair[0])
    return [track for _, track in found[:limit]]


class _Memory(threading.local):
    """The finder that a thread used last: its working memory takes longer to make than a search takes."""

    finder: Finder[Any] | None = None
    wanted: tuple[Any, ...] = ()


_memory = _Memory()


def _finder(family: type[S], width: int, height: int, candidates: int) -> Finder[S]:
    """Working memory for a search in this thread."""
    finder, wanted = _memory.finder, (family, width, height, candidates)
    if finder is None or _memory.wanted != wanted:
        parameters = SearchParameters(candidates=candidates)
        finder = _memory.finder = Finder(Matcher(family, 64), Judge(), Searcher(width, height, parameters))
        _memory.wanted = wanted
    finder.matcher.forget()
    return finder


def channels_last(image: npt.NDArray[np.uint8]) -> npt.NDArray[np.uint8]:
    """View of a picture as (h, w, channels); a copy only where it is not in one piece or may not be written to.

    Read-only arrays are another type to the compiler, which would start in the middle of a video.
    """
    whole = image if image.flags.carray else np.array(image, order="C")
    return whole if whole.ndim == 3 else whole[:, :, np.newaxis]

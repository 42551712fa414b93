"""Detects shapes that nobody follows yet, in one strip of the image per frame: `StripSearch`."""

import math
from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.fitter import Estimate, Fitter
from matchset.fitting.validation import Prior
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.frame import Frame, channels_last
from matchset.shapes.shape import Shape, finds_itself, from_hull
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.detector import track_of
from matchset.tracking.many.sightings import is_near_one
from matchset.tracking.motion import Gate, gate_of
from matchset.tracking.search.voting import Searcher, SearchParameters
from matchset.tracking.track import Track
from matchset.tracking.track_step import precompile_search

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]

STRIPS = 3  # geometry: each half as high as the image, each overlapping the next by half


class StripSearchParameters(msgspec.Struct, frozen=True):
    """How shapes that nobody follows are detected.

    All were chosen by hand; `python -m benchmarks.crowds` would show a change.

    Parameters
    ----------
    points : int
        Lines across the outline of a candidate.
    candidates : int
        How many candidates of a strip are fitted in one frame: more finds faster in a crowd and takes longer.
    min_half_width_px, smaller : float
        Least half-width of a new shape: smaller ones are mostly noise. But what is smaller at the click from which the
        color was learned may be smaller than that by this factor, and the cells of the grid are.
    min_score : float
        MSAC score below which the fit of a candidate is given up at once. The same as in the tracker's own search.
    range_cells, range_share : float
        Search range around a candidate's outline, the larger of the two: in cells of the grid, in half-widths.
    speed : float
        Speed that a shape may have at first sight, px per frame: the fields of an interlaced picture may lie apart.
    same_distance : float
        Shapes whose centers are nearer than this, in half-widths of the larger one, are the same.
    alike : float
        How near to the size of one that is known, or was clicked, a new shape must be, as a logarithm, for the evidence
        of one more of these to be enough.
    grid : SearchParameters
        Of the coarse search of a strip.
    """

    points: int = 64
    candidates: int = 6
    min_half_width_px: float = 6.0
    smaller: float = 0.5
    min_score: float = 0.25
    range_cells: float = 2.0
    range_share: float = 0.2
    speed: float = 8.0
    same_distance: float = 0.7
    alike: float = 0.4
    grid: SearchParameters = SearchParameters()


class _Searched(NamedTuple):
    """What is known of what a part of the image is searched for.

    Attributes
    ----------
    stride : int
        Size of a cell, px.
    expected : bool
        Whether it is expected there.
    sizes : list of float
        Half-widths of others like it, px.
    """

    stride: int
    expected: bool
    sizes: list[float]


class _Start(NamedTuple):
    """Where a fit may begin: a place, px, and a state of the family; None for that of a circle."""

    place: Gate
    state: Floats | None


class StripSearch:
    """Detects shapes of one color that nobody follows yet; the whole image takes three frames.

    A strip is searched on its coarse grid alone; its candidates are fitted in the image itself, so a shape may be
    larger than its strip. The strips overlap by half, so every center is well inside one of them.

    Parameters
    ----------
    family : type
    color : ColorModel
    parameters : StripSearchParameters, optional
    """

    def __init__(self, family: type[Shape], color: ColorModel, parameters: StripSearchParameters | None = None) -> None:
        self.family, self.color = family, color
        self.parameters = parameters or StripSearchParameters()
        self._fitter: Fitter[Any] = tracking_fitter(family, self.parameters.points)
        self._searchers: dict[tuple[int, int], Searcher] = {}
        self._strip = 0
        circle = color.circle
        self._expected = math.inf if circle is None else self.parameters.smaller * circle[2]
        precompile_search(family, color.table.size, color.channels)

    def update(self, frame: Frame, known: Sequence[Gate]) -> list[Track[Any]]:
        """Search the next strip.

        Parameters
        ----------
        frame : Frame
        known : sequence of Gate
            What is followed already, or expected.

        Returns
        -------
        list of Track
            Confirmed shapes that are none of these, best first.
        """
        height, width = frame.image.shape[:2]
        size = max(height // 2, 1)
        top = self._strip * (height - size) // (STRIPS - 1)
        self._strip = (self._strip + 1) % STRIPS
        return self._within(frame, (0, top, width, size), known, False)

    def near(self, frame: Frame, place: Gate, known: Sequence[Gate]) -> list[Track[Any]]:
        """Search a quarter of the image around a place; otherwise as `update`."""
        height, width = frame.image.shape[:2]
        columns, rows = max(width // 2, 1), max(height // 2, 1)
        left = round(min(max(place.x - 0.5 * columns, 0.0), width - columns))
        top = round(min(max(place.y - 0.5 * rows, 0.0), height - rows))
        return self._within(frame, (left, top, columns, rows), known, True)

    def _within(
        self, frame: Frame, box: tuple[int, int, int, int], known: Sequence[Gate], expected: bool
    ) -> list[Track[Any]]:
        """Search a part of the image: left, top, columns and rows, px."""
        image, (left, top, columns, rows) = channels_last(frame.image), box
        self._fitter.take_rows(frame.rows)
        searcher = self._searchers.get((columns, rows))
        if searcher is None:
            searcher = self._searchers[columns, rows] = Searcher(columns, rows, self.parameters.grid, self._expected)
        part = np.ascontiguousarray(image[top : top + rows, left : left + columns])
        found: list[Track[Any]] = []
        circle = self.color.circle
        sizes = [place.half_width for place in known] + ([] if circle is None else [circle[2]])
        taken, fitted = list(known), 0
        for start in self._starts(searcher, part, (left, top)):
            if fitted == self.parameters.candidates:
                break
            if is_near_one(start.place, taken, self.parameters.same_distance):
                continue
            fitted += 1
            estimate = self._fit(image, start, _Searched(searcher.stride, expected, sizes))
            if estimate is None or is_near_one(
                gate_of(self.family, estimate.state), taken, self.parameters.same_distance
            ):
                continue
            taken.append(gate_of(self.family, estimate.state))
            found.append(track_of(self._fitter, None, frame.time, pixel_aspect=frame.pixel_aspect))
        self._fitter.forget()
        return found

    def _starts(self, searcher: Searcher, part: Image, corner: tuple[int, int]) -> Iterator[_Start]:
        """Where something in a part of the image may be, likeliest first."""
        left, top = corner
        if not finds_itself(self.family):
            for x, y, radius, _ in searcher.candidates(part, self.color).tolist():
                yield _Start(Gate(x + left, y + top, radius), None)
            return
        for hull in searcher.hulls(part, self.color):
            shape = next(iter(from_hull(self.family, hull + np.array((left, top), np.float64))), None)
            if shape is not None:
                yield _Start(gate_of(self.family, shape.state), shape.state)

    def _fit(self, image: Image, start: _Start, searched: _Searched) -> Estimate | None:
        """Fit a shape about a state, first at rest and then moving; None if nothing there is one."""
        limits, fitter, place = self.parameters, self._fitter, start.place
        state = self.family.from_coarse(*place).state if start.state is None else start.state
        reach = max(limits.range_cells * searched.stride, limits.range_share * place.half_width)
        least = min(limits.min_half_width_px, self._expected)
        at_rest = SearchWindow(reach, min_score=limits.min_score)
        moving = SearchWindow(reach, limits.speed, velocity_unknown=True)
        for window in (at_rest, moving):
            estimate = fitter.fit(image, self.color, state, window)
            if estimate.is_fitted and estimate.fit.half_width >= least:
                prior = self._prior(estimate.fit.half_width, searched)
                if prior is Prior.PRESENT and not fitter.validate_detection(estimate, prior):
                    return estimate
                estimate = fitter.weigh(estimate, image, self.color)
                if not fitter.validate_detection(estimate, prior):
                    return estimate
                state = estimate.state
            elif not searched.expected:
                return None
        return None

    def _prior(self, half_width: float, searched: _Searched) -> Prior:
        """Say what is known beforehand of a shape of a size: there are others like it, or it needs more evidence."""
        if searched.expected:
            return Prior.HERE
        alike = any(abs(math.log(half_width / size)) < self.parameters.alike for size in searched.sizes)
        return Prior.PRESENT if alike else Prior.NONE

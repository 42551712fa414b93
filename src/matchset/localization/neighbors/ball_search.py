"""Detects balls that nobody follows yet, in one strip of the image per frame: `BallSearch`."""

import math
from collections.abc import Sequence

import msgspec

from matchset.fitting.fitter import Fitter
from matchset.fitting.workspace import SearchWindow
from matchset.image.color import ColorModel
from matchset.image.frame import Frame, channels_last
from matchset.shapes.circle import Circle
from matchset.tracking.compiled_step import tracking_fitter
from matchset.tracking.search.voting import Searcher, SearchParameters
from matchset.tracking.track_step import precompile_search

STRIPS = 3  # geometry: each half as high as the image, each overlapping the next by half


class BallSearchParameters(msgspec.Struct, frozen=True):
    """How balls that nobody follows are detected.

    All were chosen by hand; `python -m benchmarks --only localization_neighbors` would show a change.

    Parameters
    ----------
    points : int
        Lines across the outline of a candidate.
    candidates : int
        How many candidates of a strip are fitted in one frame: more finds faster in a crowd and takes longer.
    min_radius_px : float
        Least radius of a new ball: smaller ones are mostly noise.
    min_score : float
        MSAC score below which the fit of a candidate is given up at once. The same as in the tracker's own search.
    range_cells, range_radii : float
        Search range around a candidate's outline, the larger of the two: in cells of the grid, in radii.
    same_distance : float
        Circles whose centers are nearer than this, in radii of the larger one, are the same ball.
    grid : SearchParameters
        Of the coarse search of a strip.
    """

    points: int = 64
    candidates: int = 4
    min_radius_px: float = 6.0
    min_score: float = 0.25
    range_cells: float = 2.0
    range_radii: float = 0.2
    same_distance: float = 0.7
    grid: SearchParameters = SearchParameters()


class BallSearch:
    """Detects balls that nobody follows yet; the whole image takes three frames.

    A strip is searched on its coarse grid alone; its candidates are fitted in the image itself, so a ball may be larger
    than its strip. The strips overlap by half, so every ball's center is well inside one of them.

    Parameters
    ----------
    color : ColorModel
        Of the balls.
    parameters : BallSearchParameters, optional
    """

    def __init__(self, color: ColorModel, parameters: BallSearchParameters | None = None) -> None:
        self.color = color
        self.parameters = parameters or BallSearchParameters()
        self._fitter: Fitter[Circle] = tracking_fitter(Circle, self.parameters.points)
        self._searcher: Searcher | None = None
        self._strip = 0
        precompile_search(Circle, color.table.size, color.channels)

    def update(self, frame: Frame, known: Sequence[Circle]) -> list[Circle]:
        """Search the next strip.

        Parameters
        ----------
        frame : Frame
        known : sequence of Circle
            Balls that are followed already, or expected.

        Returns
        -------
        list of Circle
            Confirmed balls that are none of these, best first.
        """
        image = channels_last(frame.image)
        self._fitter.take_rows(frame.rows)
        height, width = image.shape[:2]
        size = width, max(height // 2, 1)
        if self._searcher is None or self._searcher.size != size:
            self._searcher = Searcher(*size, self.parameters.grid)
        top = self._strip * (height - size[1]) // (STRIPS - 1)
        self._strip = (self._strip + 1) % STRIPS
        found: list[Circle] = []
        limits, fitted = self.parameters, 0
        for x, y, radius, _ in self._searcher.candidates(image[top : top + size[1]], self.color).tolist():
            rough = Circle(x, y + top, radius)
            if self._is_known(rough, [*known, *found]) or fitted == limits.candidates:
                continue
            fitted += 1
            reach = max(limits.range_cells * self._searcher.stride, limits.range_radii * radius)
            window = SearchWindow(reach, min_score=limits.min_score)
            estimate = self._fitter.fit(image, self.color, rough.state, window)
            if not estimate.is_fitted or estimate.fit.half_width < limits.min_radius_px:
                continue
            if self._fitter.validator.validate_detection(estimate.fit):
                continue
            circle = Circle.from_state(estimate.state)
            if not self._is_known(circle, [*known, *found]):
                found.append(circle)
        self._fitter.forget()
        return found

    def _is_known(self, circle: Circle, others: Sequence[Circle]) -> bool:
        """Whether a circle is one of the others, or inside one, or around one."""
        return any(
            math.hypot(circle.x - other.x, circle.y - other.y)
            < self.parameters.same_distance * max(circle.radius, other.radius)
            for other in others
        )

"""Whether the target is alone with its color in the picture: `Prominence`.

A small, blurred or cut ball has an outline that chance explains as well, and yet anybody sees it at once where nothing
else has its color. So while a target is seen, its color step (`color_steps`) is measured, and the largest one anywhere
else in the picture: its rival. After a loss a shape of about its size whose color step is as clear as the target's was,
and clearer than those of all rivals, is most likely the target, wherever it is. What was in the picture beside the
target counts as a rival for good, so that a thing of its color that stays when it leaves is not taken for it. Only
where the camera stands and all rivals are still in their places, a new place that is as clear as they are can be no
rival but the target.
"""

import math
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.tracking.motion import Gate
from matchset.tracking.search.blobs import color_steps
from matchset.tracking.search.voting import SearchParameters, sample_grid, stride_for

Image = npt.NDArray[np.uint8]
Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]

SIZES = (math.sqrt(0.5), 1.0, math.sqrt(2.0))  # geometry: of the discs that are compared, half-widths
NEAR, ELSEWHERE = 0.5, 2.0  # geometry: how far from a shape is at it, and from where on is elsewhere, half-widths
PARTS, SAMPLES = 24, 96  # format: parts in a row of a picture, and pixels that are read of it
NO_RIVAL = -2.0  # theorem: least difference of two means of whiteness, each -1 ... 1


class ProminenceParameters(msgspec.Struct, frozen=True):
    """When a target that was lost is known again by its color alone being there.

    Chosen on `yellow_occlusion` at 320 px and H.264, and held against clips that were not looked at (docs/log.md);
    `python -m benchmarks --only real,false_locks` would show a change.

    Parameters
    ----------
    period : int
        Frames between two measurements while the target is tracked: less sees rivals sooner and takes longer.
    lead : float
        Least difference of the target's color step and that of its clearest rival, whiteness; 2 is most. The balls of
        four clips lead by 0.6 to 1.6. Less finds more targets among other things of their color, and more such things.
    kept : float
        Least color step of a shape that is the target, as a share of the target's own: less bears more blur and shade.
    growth : float
        Largest change of size since the target was seen or measured last, as a factor.
    same_px, same_share : float
        Change of brightness up to which a part of the picture is as it was, gray levels, and the share of parts from
        which the camera stands. A hand before a still camera left 0.77 and more, other rooms had 0.24 and less.
    """

    period: int = 30
    lead: float = 0.5
    kept: float = 0.6
    growth: float = 1.4


class _StepMap(NamedTuple):
    """Cells of a grid, px, half-width in cells, and the clearest color step at each cell; empty if too large."""

    stride: int
    radius: float
    clearest: Singles

    def steps(self, place: Gate) -> tuple[float | None, float]:
        """Color step of a shape, None where the picture is too small for it, and the largest one elsewhere."""
        if not self.clearest.size:
            return None, NO_RIVAL
        own = float(self.clearest[_around(*self._cell(place), max(NEAR * self.radius, 1.0))].max(initial=NO_RIVAL))
        others = self.clearest.copy()
        others[_around(*self._cell(place), ELSEWHERE * self.radius + 1.0)] = NO_RIVAL
        return own, float(others.max())

    def _cell(self, place: Gate) -> tuple[float, float]:
        """Column and row of a place; cells are read a quarter and a half of the way through them."""
        return place.x / self.stride - 0.25, place.y / self.stride - 0.5


class Prominence:
    """How clearly a target stands out by its color, where it was seen.

    Parameters
    ----------
    limits : ProminenceParameters
    search : SearchParameters
        Cells of the grid.
    """

    def __init__(self, limits: ProminenceParameters, search: SearchParameters) -> None:
        self._limits, self._search = limits, search
        self.forget()

    def forget(self) -> None:
        """Be as one is that has seen nothing."""
        self._own: float | None = None
        self._rival, self._size = NO_RIVAL, 0.0

    def is_due(self, frames: int) -> bool:
        """Whether the target should be measured, after so many frames."""
        return self._own is None or frames % self._limits.period == 0

    def measure(self, image: Image, color: ColorModel, seen: Gate) -> None:
        """Measure a target that is seen; where it is far less clear than before, it is not what was measured.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        seen : Gate
            Where it is.
        """
        steps = self._map(image, color, seen.half_width)
        own, rival = steps.steps(seen)
        if own is not None and (self._own is None or own > self._limits.kept * self._own):
            self._own, self._rival, self._size = own, max(self._rival, rival), seen.half_width

    def recognizes(self, image: Image, color: ColorModel, last: float, found: Gate) -> bool:
        """Whether a shape is the lost target, since nothing else in the picture has or had its color so clearly.

        Parameters
        ----------
        image, color
            See `measure`.
        last : float
            Half-width of the target as it was seen last, px; that when it was measured counts as well, since a track
            that is about to be lost often has another.
        found : Gate
            Where the shape is.
        """
        limits = self._limits
        if self._own is None or self._own - self._rival < limits.lead:
            return False
        if not any(1.0 / limits.growth < found.half_width / size < limits.growth for size in (last, self._size)):
            return False
        own, rival = self._map(image, color, found.half_width).steps(found)
        return own is not None and own > max(limits.kept * self._own, max(rival, self._rival) + limits.lead)

    def _map(self, image: Image, color: ColorModel, half_width: float) -> "_StepMap":
        """Color steps of discs of about a size, at each cell of a grid."""
        height, width = image.shape[:2]
        stride = stride_for(width, self._search, half_width)
        grid = np.zeros((height // stride, width // stride), np.int16)
        radius = max(half_width / stride, 1.0)
        sample_grid(image, color.table, stride, grid)
        maps = [step for _, step in color_steps(grid, [size * radius for size in SIZES])] if grid.size else []
        return _StepMap(stride, radius, np.max(maps, axis=0) if maps else np.zeros((0, 0), np.float32))


def _around(x: float, y: float, reach: float) -> tuple[slice, slice]:
    """Cells of a grid within reach of a place, in rows and columns."""
    rows, columns = (slice(max(round(at - reach), 0), max(round(at + reach) + 1, 0)) for at in (y, x))
    return rows, columns

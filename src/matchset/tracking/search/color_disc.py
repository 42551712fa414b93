"""The disc of the target's color: where a small, blurred or coded ball is, whose outline no edge points confirm.

A codec that must save leaves blocks and smears of a ball of ten pixels: hardly any edge, and those that there are
belong to blocks. Its color is still there, as a spot about as large as the ball. The disc about where the ball is
expected in which the color prevails most over what is around it,

    step = mean whiteness in the disc - mean whiteness in a ring around it,

less what its place and its size are unlikely, is the ball's, if the step is about as clear as it was when its outline
was seen.
"""

import functools
import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import WHITE, ColorModel
from matchset.tracking.motion import Gate
from matchset.tracking.search.prominence import ELSEWHERE, NO_RIVAL, Prominence

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Image = npt.NDArray[np.uint8]

NOWHERE = -99.0  # theorem: less than any step
STILL = 0.25  # geometry: how far from an outline that is seen its disc may be, half-widths
FEW = 3  # theorem: cells that have something between them


class ColorDiscParameters(msgspec.Struct, frozen=True):
    """Where a disc of the target's color is looked for, and when it is the target.

    `ring`, `change`, `away`, `kept` and `lead` were chosen on small, coded clips (docs/log.md), the others by hand;
    `python -m benchmarks --only real,false_locks` would show a change.

    Parameters
    ----------
    ring : float
        How far the ring around a disc reaches, in its half-widths: 1.15 makes small discs 13 to 28 % too large, 1.5 up
        to 25 % too small.
    reach, farthest : float
        How far from where it is expected the disc may be, in half-widths: at first, and after many frames.
    growth : float
        By which factor it may be larger or smaller than expected.
    sizes : int
        How many sizes are tried.
    away, change : float
        Cost of the squared distance, in half-widths, and of the squared change of ln(size), whiteness.
    cells : float
        Most cells in a half-width: more is finer and takes longer.
    kept : float
        Least step, as a share of that with which the target's outline was seen: less bears more blur and shade, and
        takes more other things for it.
    renewed : float
        Share of its step from which an outline counts as seen as clearly as before.
    least : float
        Least step with which the target's outline must have been seen, whiteness: of 2 at most.
    lead : float
        By how much more the step must be than that of the clearest place elsewhere in the window.
    change_seen : float
        By which factor the size may differ from that when the outline was measured last.
    sigma : float
        Standard deviation of center and half-width, in half-widths.
    """

    ring: float = 1.3
    reach: float = 1.2
    farthest: float = 4.0
    growth: float = 1.25
    sizes: int = 9
    away: float = 0.2
    change: float = 3.0
    cells: float = 12.0
    kept: float = 0.7
    renewed: float = 0.8
    least: float = 0.6
    lead: float = 0.5
    change_seen: float = 1.3
    sigma: float = 0.15


class ColorDisc(NamedTuple):
    """A disc: center and half-width, px, its step, and that of the clearest place elsewhere in the window."""

    x: float
    y: float
    half_width: float
    step: float
    rival: float


class _Window(NamedTuple):
    """Whiteness of a part of the picture in cells, where these lie, px, and their size."""

    white: Singles
    across: Floats
    down: Floats
    step: float


class ColorDiscs:
    """Knows how clear the target's color was where its outline was seen, and finds discs of it that are as clear.

    Parameters
    ----------
    limits : ColorDiscParameters
    prominence : Prominence
        Knows which other places have that color.
    """

    def __init__(self, limits: ColorDiscParameters, prominence: Prominence) -> None:
        self.limits, self._prominence = limits, prominence
        self.forget()

    def forget(self) -> None:
        """Be as one is that has seen nothing."""
        self._own, self._size = NOWHERE, 0.0
        self._prominence.forget()

    def measure(self, image: Image, color: ColorModel, seen: Gate) -> None:
        """Measure a target whose outline is seen; where it is far less clear than before, it is not what was measured.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        color : ColorModel
        seen : Gate
            Where it is.
        """
        self._prominence.measure(image, color, seen)
        here = msgspec.structs.replace(self.limits, growth=1.0, sizes=1)
        found = find_color_disc(image, color, seen, STILL, here)
        if found is not None and found.step > self.limits.renewed * self._own:
            self._own, self._size = found.step, seen.half_width

    def find(self, image: Image, color: ColorModel, expected: Gate, missed: float) -> ColorDisc | None:
        """Find the disc that is the target, about where that is expected; None where none is clear enough.

        Parameters
        ----------
        image, color
            See `measure`.
        expected : Gate
            Where the target should be.
        missed : float
            For how many frames it was not seen.
        """
        limits = self.limits
        if self._own < limits.least:
            return None
        expected = expected._replace(half_width=self._likely(expected.half_width))
        reach = min(limits.reach * max(0.5 * missed, 1.0), limits.farthest)
        found = find_color_disc(image, color, expected, reach, limits)
        if found is None or found.step < max(limits.kept * self._own, found.rival + limits.lead):
            return None
        return found if Gate(*found[:3]).is_whole(image) else None

    def find_anywhere(self, image: Image, color: ColorModel, last: float) -> ColorDisc | None:
        """Find the disc that is the target where that alone has its color; None where no place is so clear.

        Parameters
        ----------
        image, color
            See `measure`.
        last : float
            Half-width of the target as it was seen last, px.
        """
        place = self._prominence.clearest(image, color, self._likely(last)) if self._own >= self.limits.least else None
        found = self.find(image, color, place, 1.0) if place else None
        return found if found and self._likely(found.half_width) == found.half_width else None

    def _likely(self, half_width: float) -> float:
        """Half-width nearest to one, px, that the target may have, since it was measured."""
        change = self.limits.change_seen
        return min(max(half_width, self._size / change), self._size * change)


def find_color_disc(
    image: Image, color: ColorModel, expected: Gate, reach: float, limits: ColorDiscParameters
) -> ColorDisc | None:
    """Find the disc of the target's color about where it is expected, whatever its step.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ColorModel
    expected : Gate
        Center and half-width, px.
    reach : float
        How far from there, in half-widths.
    limits : ColorDiscParameters

    Returns
    -------
    ColorDisc or None
        None where the place is not in the picture.
    """
    window = _read(image, color, expected, reach, limits)
    if window is None:
        return None
    size, most, found = expected.half_width, NOWHERE, None
    away = np.hypot(window.across - expected.x, window.down[:, np.newaxis] - expected.y) / size
    for factor in np.geomspace(1.0 / limits.growth, limits.growth, limits.sizes).tolist():
        kernel = disc_filter(round(factor * size / window.step, 2), limits.ring)
        steps = cv2.filter2D(window.white, cv2.CV_32F, kernel, borderType=cv2.BORDER_REPLICATE)
        merit = steps - limits.away * away**2 - limits.change * math.log(factor) ** 2
        merit[away > reach] = NOWHERE
        row, column = np.unravel_index(int(merit.argmax()), merit.shape)
        if merit[row, column] > most:
            most, x, y = float(merit[row, column]), float(window.across[column]), float(window.down[row])
            apart = np.hypot(window.across - x, window.down[:, np.newaxis] - y) > ELSEWHERE * factor * size
            rival = float(steps[apart].max(initial=NO_RIVAL))
            found = ColorDisc(x, y, factor * size, float(steps[row, column]), rival)
    return found


def _read(image: Image, color: ColorModel, expected: Gate, reach: float, limits: ColorDiscParameters) -> _Window | None:
    """Read the whiteness around a place; None where that is not in the picture."""
    half = expected.half_width * (reach + limits.growth * (limits.ring + 1.0))
    left, top = max(round(expected.x - half), 0), max(round(expected.y - half), 0)
    right, bottom = max(round(expected.x + half), 0) + 1, max(round(expected.y + half), 0) + 1
    cut = np.ascontiguousarray(image[top:bottom, left:right])
    if min(cut.shape[:2]) < FEW:
        return None
    white = np.asarray(color.scores(cut).reshape(cut.shape[:2]) / WHITE, np.float32)
    step = max(expected.half_width / limits.cells, 1.0)
    rows, columns = (max(round(n / step), FEW) for n in white.shape)
    if step > 1.0:
        white = np.asarray(cv2.resize(white, (columns, rows), interpolation=cv2.INTER_AREA), np.float32)
    across = (np.arange(columns) + 0.5) * cut.shape[1] / columns - 0.5 + left
    down = (np.arange(rows) + 0.5) * cut.shape[0] / rows - 0.5 + top
    return _Window(white, across, down, step)


@functools.lru_cache(maxsize=256)
def disc_filter(radius: float, ring: float) -> Singles:
    """Filter that gives the mean in a disc less that in the ring around it, which is a cell wide at least.

    Parameters
    ----------
    radius : float
        Of the disc, cells.
    ring : float
        Radius of the ring, in those of the disc.
    """
    outer = max(radius * ring, radius + 1.0)
    n = math.ceil(outer)
    away = np.hypot(*np.mgrid[-n : n + 1, -n : n + 1])
    disc = np.clip(radius + 0.5 - away, 0.0, 1.0)
    around = np.clip(outer + 0.5 - away, 0.0, 1.0) - disc
    return np.asarray(disc / disc.sum() - around / around.sum(), np.float32)

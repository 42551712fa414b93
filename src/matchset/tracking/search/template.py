"""Where a target looks as it did when it was seen last: `Template` (normalized cross-correlation).

A small ball in a compressed picture may have neither an outline that edges confirm nor a color that its background has
not. But from one picture to the next it looks the same, and the place where it does is found by correlation with the
picture around it (Lewis, "Fast Normalized Cross-Correlation", 1995). Such a template drifts, and correlates with the
background that it holds; so it bridges a gap, it does not track: for a limited time after something else was seen, near
the prediction, and only where nothing else there looks as much like it.
"""

import math
from typing import NamedTuple

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.tracking.motion import Gate

Image = npt.NDArray[np.uint8]
Singles = npt.NDArray[np.float32]

ELSEWHERE = 1.0  # geometry: from where on a place is another one, half-widths
INSIDE, OUTSIDE, BESIDE = 0.85, 1.2, 1.7  # geometry: where the target, and what is around it, is looked at, half-widths
NONE = -1.0  # theorem: least correlation


class TemplateParameters(msgspec.Struct, frozen=True):
    """Where a place that looks like the target is looked for, and when it is the target.

    Chosen on small, coded clips (docs/log.md); `python -m benchmarks --only real,false_locks` would show a change.

    Parameters
    ----------
    cells : int
        Cells along a side of the template: more is finer and takes longer.
    around : float
        Half the side of the template, half-widths of the target: less drifts, more correlates with the background.
    largest_px : float
        Largest half-width of a target that is followed so, px: outlines of larger ones are seen.
    reach, farthest : float
        How far from where it is expected the target may be, half-widths: at first, and after many frames.
    growth : float
        By which factor it may be larger or smaller than expected.
    away, change : float
        Cost of the squared distance, half-widths, and of |ln(size)|, correlation.
    least : float
        Least correlation: less bears more change of looks, and takes more other things for the target.
    lead : float
        By how much more it must be than at the clearest place elsewhere in the window.
    stands_out : float
        Least step between the target and what is around it, in standard deviations of that, `even` gray levels added:
        it was 4.3 to 11 for balls before plain walls, and at most 2.7 in hands and before leaves, where a template
        drifts, since it holds the background.
    even : float
        Gray levels.
    renewed : float
        Share of what is found in the template from then on: more follows changes of looks, and drifts.
    longest : float
        For how long a target is followed by its looks alone, s.
    sigma : float
        Standard deviation of center and half-width, half-widths.
    """

    cells: int = 16
    around: float = 1.3
    largest_px: float = 24.0
    reach: float = 2.0
    farthest: float = 3.5
    growth: float = 1.075
    away: float = 0.02
    change: float = 0.5
    least: float = 0.6
    lead: float = 0.15
    stands_out: float = 3.0
    even: float = 2.0
    renewed: float = 0.1
    longest: float = 2.0
    sigma: float = 0.2


class Likeness(NamedTuple):
    """A place that looks like the target: center and half-width, px, correlation there and elsewhere."""

    x: float
    y: float
    half_width: float
    correlation: float
    rival: float


class Template:
    """Knows how the target looked, and finds the place where something looks so.

    Parameters
    ----------
    limits : TemplateParameters
    """

    def __init__(self, limits: TemplateParameters) -> None:
        self.limits = limits
        self.forget()

    def forget(self) -> None:
        """Be as one is that has seen nothing."""
        self._look: Singles | None = None
        self._since = -math.inf

    def learn(self, image: Image, seen: Gate, time: float) -> None:
        """Remember how the target looks.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        seen : Gate
            Where it is.
        time : float
            Of the picture, s.
        """
        self._since = time
        fits = seen.half_width < self.limits.largest_px and self._stands_out(image, seen)
        self._look = self._read(image, seen, 0.0) if fits else None

    def _stands_out(self, image: Image, seen: Gate) -> bool:
        """Whether a target stands out from what is around it, but for a slope in brightness there."""
        part = self._read(image, seen, BESIDE - self.limits.around)
        rows, columns = np.indices(part.shape[:2]) - 0.5 * (part.shape[0] - 1)
        away = np.hypot(rows, columns) * (2.0 * self.limits.around / self.limits.cells)
        inside, around = part[away < INSIDE], part[away > OUTSIDE]
        terms = np.column_stack((np.ones(len(around)), rows[away > OUTSIDE], columns[away > OUTSIDE]))
        rest = around - terms @ np.linalg.lstsq(terms, around, rcond=None)[0]
        step = float(np.linalg.norm(inside.mean(axis=0) - around.mean(axis=0)))
        return step >= self.limits.stands_out * (math.sqrt(float((rest**2).sum(axis=1).mean())) + self.limits.even)

    def find(self, image: Image, expected: Gate, missed: float, time: float) -> Likeness | None:
        """Find the target about where it is expected, and remember how it looks there; None where nothing is like it.

        Parameters
        ----------
        image : ndarray of shape (h, w, channels), uint8
        expected : Gate
            Where it should be.
        missed : float
            For how many frames it was not seen.
        time : float
            Of the picture, s.
        """
        limits, look = self.limits, self._look
        if look is None or time - self._since > limits.longest or expected.half_width >= limits.largest_px:
            return None
        if look.shape[2:] != image.shape[2:]:
            return None
        reach = min(limits.reach * max(0.5 * missed, 1.0), limits.farthest)
        sizes = [expected.half_width * factor for factor in (1.0 / limits.growth, 1.0, limits.growth)]
        found = max(
            (self._best(image, look, expected._replace(half_width=size), reach, size / sizes[1]) for size in sizes),
            key=lambda each: each[0],
        )[1]
        if found.correlation < max(limits.least, found.rival + limits.lead):
            return None
        place = Gate(*found[:3])
        if not place.is_whole(image):
            return None
        here = self._read(image, place, 0.0)
        self._look = np.asarray((1.0 - limits.renewed) * look + limits.renewed * here, np.float32)
        return found

    def _best(self, image: Image, look: Singles, place: Gate, reach: float, factor: float) -> tuple[float, Likeness]:
        """Merit and place of what is most like the target in a size, about a place."""
        limits, cell = self.limits, 2.0 * self.limits.around * place.half_width / self.limits.cells
        window = self._read(image, place, reach)
        alike = np.nan_to_num(cv2.matchTemplate(window, look, cv2.TM_CCOEFF_NORMED), nan=NONE, posinf=NONE, neginf=NONE)
        along = (np.arange(alike.shape[0]) - 0.5 * (alike.shape[0] - 1)) * cell  # px from the place expected
        away = (along[:, np.newaxis] ** 2 + along**2) / place.half_width**2
        merit = alike - limits.away * away - limits.change * abs(math.log(factor))
        row, column = np.unravel_index(int(merit.argmax()), merit.shape)
        apart = np.hypot(along - along[column], (along - along[row])[:, np.newaxis]) > ELSEWHERE * place.half_width
        found = Likeness(
            place.x + float(along[column]),
            place.y + float(along[row]),
            place.half_width,
            float(alike[row, column]),
            float(alike[apart].max(initial=NONE)),
        )
        return float(merit[row, column]), found

    def _read(self, image: Image, place: Gate, reach: float) -> Singles:
        """Read a square about a place, in cells; the border of the picture goes on outside of it."""
        limits = self.limits
        cell = 2.0 * limits.around * place.half_width / limits.cells
        side = limits.cells + 2 * round(reach * place.half_width / cell)
        first = 0.5 * (side - 1) * cell
        how = np.array([[cell, 0.0, place.x - first], [0.0, cell, place.y - first]])
        part = cv2.warpAffine(
            image, how, (side, side), flags=cv2.INTER_LINEAR | cv2.WARP_INVERSE_MAP, borderMode=cv2.BORDER_REPLICATE
        )
        return np.asarray(part.reshape(side, side, -1), np.float32)

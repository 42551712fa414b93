"""Where the color of discs that were found is not covered by them: `uncovered_places`.

In a heap nothing stands out from what is around it. But wherever there is color that no known disc covers, there is
another: at the middles of what is left, where the distance to the border (Rosenfeld & Pfaltz, 1966) has a peak about
as high as a disc of that radius has. The rounder the peak, the likelier: the middle line of a bar is none.
"""

import math
from collections.abc import Sequence

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.color import ColorModel
from matchset.image.disc_network.lab import lab_of
from matchset.image.disc_network.patch_format import Circle3

Floats = npt.NDArray[np.float64]
Singles = npt.NDArray[np.float32]
Image = npt.NDArray[np.uint8]
LEAST_CELLS = 3  # format: along each side of a picture that is read


class UncoveredPlaceParameters(msgspec.Struct, frozen=True):
    """Which places are proposed; chosen by hand.

    Parameters
    ----------
    radius_cells : float
        Radius in cells: more is finer and takes longer.
    lightness, chroma : float
        Differences from the color of a disc that was found at which a cell is no longer like it, CIE Lab.
    colors, unlike : int, float
        With how many colors of discs a cell is compared, and how far these are apart, in shares of the differences
        above: more colors take longer.
    covered, in_vain : float
        Share of its radius that is left out around a disc that was found, and around a place where there was none.
    least : float
        Least distance of a place from the border of the color, radii: less finds discs that are mostly hidden, and
        proposes more places in vain.
    apart : float
        Least distance of two places, radii.
    larger : float
        The network is led from circles so many times as large as the radius that is looked for.
    """

    radius_cells: float = 4.0
    lightness: float = 40.0
    chroma: float = 20.0
    colors: int = 12
    unlike: float = 0.3
    covered: float = 0.9
    in_vain: float = 0.5
    least: float = 0.5
    apart: float = 0.5
    larger: float = 1.05


class _Cells:
    """Between the pixels of a picture and the cells in which it is read, some to a radius."""

    def __init__(self, image: Image, radius: float, limits: UncoveredPlaceParameters) -> None:
        self._height, self._width = image.shape[:2]
        self._step = max(radius / limits.radius_cells, 1.0)
        self.columns, self.rows = int(self._width / self._step), int(self._height / self._step)
        self.radius = radius / self._step

    def erase(self, values: npt.NDArray[np.uint8] | Singles, circle: Sequence[float], share: float) -> None:
        """Write 0 within a share of the radius of a circle, px."""
        x = (circle[0] + 0.5) * self.columns / self._width - 0.5
        y = (circle[1] + 0.5) * self.rows / self._height - 0.5
        cv2.circle(values, (round(x), round(y)), round(share * circle[2] / self._step), 0.0, -1)

    def place(self, column: int, row: int) -> tuple[float, float]:
        """Middle of a cell, px."""
        return (column + 0.5) * self._width / self.columns - 0.5, (row + 0.5) * self._height / self.rows - 0.5


def uncovered_places(
    image: Image,
    known: tuple[Sequence[Floats], ColorModel],
    radius: float,
    without: tuple[Sequence[Circle3], Sequence[Circle3]],
    most: int,
    limits: UncoveredPlaceParameters,
) -> list[Circle3]:
    """Propose circles of a radius where there is color that no known disc covers, the roundest first.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    known : (sequence of ndarray of shape (3,), ColorModel)
        Colors of discs that were found, CIE Lab, and what was learned at the click.
    radius : float
        px.
    without : (sequence of circle, sequence of circle)
        Discs that were found, and places where there was none.
    most : int
        How many at most.
    limits : UncoveredPlaceParameters

    Returns
    -------
    list of (x, y, radius)
        Circles from which the network is led, px.
    """
    cells = _Cells(image, radius, limits)
    if min(cells.columns, cells.rows) < LEAST_CELLS:
        return []
    small = cv2.resize(image, (cells.columns, cells.rows), interpolation=cv2.INTER_AREA)
    mask = _alike(np.asarray(small.reshape(cells.rows, cells.columns, -1), np.uint8), known, limits)
    found, vain = without
    for circle in found:
        cells.erase(mask, circle, limits.covered)
    far = np.asarray(cv2.distanceTransform(mask, cv2.DIST_L2, 5), np.float32)
    side = 2 * round(cells.radius) + 1
    round_ones = far - cv2.boxFilter(far, -1, (side, side), borderType=cv2.BORDER_REPLICATE)
    round_ones[far < limits.least * cells.radius] = 0.0
    for circle in vain:
        cells.erase(round_ones, circle, limits.in_vain)
    places = list[Circle3]()
    while len(places) < most:
        _, best, _, (column, row) = cv2.minMaxLoc(round_ones)
        if best <= 0.0:
            break
        places.append((*cells.place(column, row), limits.larger * radius))
        cv2.circle(round_ones, (column, row), math.ceil(limits.apart * cells.radius), 0.0, -1)
    return places


def _alike(
    cells: Image, known: tuple[Sequence[Floats], ColorModel], limits: UncoveredPlaceParameters
) -> npt.NDArray[np.uint8]:
    """Cells that look like one of the discs, or as the color model says: 1, others 0."""
    labs, color = known
    scales = np.array((limits.lightness, limits.chroma, limits.chroma))
    light, green, yellow = cv2.split(np.asarray(lab_of(cells) / scales.astype(np.float32), np.float32))
    alike = np.zeros(light.shape, bool)
    for one, two, three in (lab / scales for lab in _unlike(labs, scales, limits)):
        away = (light - np.float32(one)) ** 2
        away += (green - np.float32(two)) ** 2
        away += (yellow - np.float32(three)) ** 2
        alike |= away < 1.0
    if not (color.is_local or color.gray):
        alike |= color.scores(np.ascontiguousarray(cells)).reshape(alike.shape) > 0
    return alike.astype(np.uint8)


def _unlike(labs: Sequence[Floats], scales: Floats, limits: UncoveredPlaceParameters) -> list[Floats]:
    """Colors of which no two are alike."""
    kept = list[Floats]()
    for lab in labs:
        if len(kept) < limits.colors and all(np.hypot.reduce((lab - each) / scales) > limits.unlike for each in kept):
            kept.append(lab)
    return kept

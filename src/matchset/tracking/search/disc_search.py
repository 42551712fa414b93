"""Where in a picture discs stand out from what is around them: `contrasting_discs`.

A ball that was thrown is many radii from where it was expected, perhaps smeared, and its color may not tell it from the
picture. But about its size is known, and the color of its middle. The picture is reduced until the disc is a few
pixels, and of each place the mean color of a disc and of the ring around it are read (difference of boxes, the
center-surround of Itti et al., 1998). A place is likelier the more both differ, and the less the disc's mean differs
from the color that was seen. The maxima of that are where the network of discs is asked.
"""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.lab import lab_of
from matchset.tracking.motion import Gate

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Singles = npt.NDArray[np.float32]


class DiscSearchParameters(msgspec.Struct, frozen=True):
    """Which discs are looked at; chosen by hand.

    Parameters
    ----------
    reach : float
        Half the side of the window around where the target should be, half-widths for each frame that it was missed.
    beyond : float
        How many times as large a second window is: in videos of few pictures a second a target goes farther than was
        expected. More log-odds are asked there (`NetworkParameters.anywhere_lost`). More finds targets that went
        farther, and takes other things for them.
    radius_px : float
        Radius to which the picture is reduced, px: more is finer and takes longer.
    rim : float
        Share of the radius within which the mean color of a disc is read.
    ring : (float, float)
        Radii between which that of its surroundings is read.
    contrast : float
        Difference of both that is half as good as a large one, units of CIE Lab.
    lightness, chroma : float
        Standard deviations of a target's color, units of CIE Lab.
    apart : float
        Least distance of two discs, radii.
    most : int
        How many discs are looked at: each takes the time of a few looks of the network.
    least : float
        Least merit of a disc, of 1.
    larger : float
        A lost target's size may be that of its lit part: the network is led from circles so many times as large.
    """

    reach: float = 3.0
    beyond: float = 2.0
    radius_px: float = 4.0
    rim: float = 0.8
    ring: tuple[float, float] = (1.3, 1.8)
    contrast: float = 10.0
    lightness: float = 15.0
    chroma: float = 10.0
    apart: float = 1.0
    most: int = 5
    least: float = 0.1
    larger: float = 1.3


def contrasting_discs(
    image: Image, color: Floats, place: Gate, reach: float, limits: DiscSearchParameters
) -> list[Gate]:
    """Find discs that stand out around a place, the likeliest first.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    color : ndarray of shape (3,), float64
        Color of the target's middle, CIE Lab.
    place : Gate
        Where it is looked for, and its size.
    reach : float
        Half the side of the window around that, px.
    limits : DiscSearchParameters
    """
    left, top = max(math.floor(place.x - reach), 0), max(math.floor(place.y - reach), 0)
    part = image[top : max(math.ceil(place.y + reach) + 1, 0), left : max(math.ceil(place.x + reach) + 1, 0)]
    scale = min(limits.radius_px / place.half_width, 1.0)
    columns, rows = (round(scale * side) for side in part.shape[1::-1])
    if min(columns, rows) < 1:
        return []
    small = cv2.resize(part, (columns, rows), interpolation=cv2.INTER_AREA) if scale < 1.0 else part
    merit = _merits(lab_of(np.asarray(small, np.uint8)), color, scale * place.half_width, limits)
    side = 2 * math.ceil(limits.apart * scale * place.half_width) + 1
    peaks = (merit == cv2.dilate(merit, np.ones((side, side), np.uint8))) & (merit > limits.least)
    where = np.argwhere(peaks)
    order = np.argsort(-merit[peaks], kind="stable")[: limits.most]
    across, down = columns / part.shape[1], rows / part.shape[0]
    return [
        Gate((column + 0.5) / across - 0.5 + left, (row + 0.5) / down - 0.5 + top, place.half_width)
        for row, column in where[order].tolist()
    ]


def _merits(lab: Singles, color: Floats, radius: float, limits: DiscSearchParameters) -> Singles:
    """How likely a disc of a radius is at each pixel, 0 ... 1."""
    disc = cv2.filter2D(lab, -1, _ring(0.0, limits.rim * radius), borderType=cv2.BORDER_REPLICATE)
    around = cv2.filter2D(lab, -1, _ring(*(share * radius for share in limits.ring)), borderType=cv2.BORDER_REPLICATE)
    differs = np.sqrt(((disc - around) ** 2).sum(axis=2))
    sigmas = np.array((limits.lightness, limits.chroma, limits.chroma), np.float32)
    off = (((disc - color.astype(np.float32)) / sigmas) ** 2).sum(axis=2)
    return np.asarray(np.exp(-0.5 * off) * (differs / (differs + np.float32(limits.contrast))), np.float32)


def _ring(inner: float, outer: float) -> Singles:
    """Weights of the mean over a ring."""
    reach = math.ceil(outer)
    rows, columns = np.ogrid[-reach : reach + 1, -reach : reach + 1]
    away = np.hypot(rows, columns)
    mask = ((away <= max(outer, 0.5)) & (away >= inner)).astype(np.float32)
    return np.asarray(mask / mask.sum(), np.float32)

"""The region of a blurred target: what looks more like the inside of a shape than like what is around it.

The rim of a ball that moves while the picture is taken, or that is out of focus, is a ramp many pixels wide. Edges of
the background, which shine through it, are sharper than that, and the sharpest place of a ramp is not where the outline
is. But a ramp is a mixture of target and background, and mixtures are linear. So Fisher's discriminant (1936) of the
pixels inside a disc and around it,

    share = w . (pixel - around) / w . (inside - around),    w = (S_inside + S_around)^-1 (inside - around),

says how much of a pixel is target, whatever pattern the background has. About where it is half, the outline was in the
middle of the exposure; the disc with the center and the area of the region above that is the target's. A sharp rim
needs none of this, and a hand or a tube that cuts the target cuts the region too: `worth` is 0 where even the sharper
part of the rim is sharp.
"""

import math
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.fitting.soft_region_kernel import MOST_CELLS, MOST_LINES, REGION_MEMORY, find_region
from matchset.image.frame import channels_last
from matchset.numeric.arguments import require
from matchset.numeric.record import ThreadBlock, fields, store

Floats = npt.NDArray[np.float64]
Image = npt.NDArray[np.uint8]
Disc = tuple[float, float, float]  # center and half-width, px


class SoftRegionParameters(msgspec.Struct, frozen=True):
    """How the region of a blurred target is found, and what it is worth.

    `level`, `soft`, `softer`, `worth` and `sigma` were chosen on real clips
    (docs/log/fitting.md#blurred-ball), the others by hand;
    `python -m benchmarks --only real` would show a change.

    Parameters
    ----------
    inner, nearest, farthest : float
        Up to where pixels are of the inside, and from where to where around it, in half-widths.
    window, border : float
        How far the picture is looked at, and the region may reach, in half-widths.
    cells : int
        Most cells of the window in a row; more is finer and takes longer.
    pixel_noise : float
        Standard deviation added to that of the pixels, gray levels: less believes small differences.
    contrast : float
        Least difference of inside and around, in standard deviations along the discriminant.
    level : float
        Share of the target from which a pixel belongs to the region: somewhat below a half, since a ball is darker at
        its rim. 0.3 makes radii 5 to 10 % too large, 0.5 as much too small.
    rounds : int
        How often the region is found anew around the one before, ...
    still : float
        ... unless it has moved and grown by less than this, in cells.
    move, growth : float
        How far the region may be from where it is expected, in half-widths, and by which factor its size may differ.
    lines : int
        How many lines across the rim are read for its width.
    high, low : float
        Shares of the target between which the rim lies.
    sharper : float
        Share of the lines that are sharper than the width that counts: a streak is sharp at its sides.
    soft, softer : float
        Width of the rim, in half-widths, from which a region is worth something, and from which all.
    agreement, agrees : float
        Intersection over union of the region and the disc from which it is worth something, and from which all.
    worth : float
        What a region is worth that is soft and a disc; less than that says how sure it is.
    sure : float
        Share of that from which a detection is fitted anew from its region, and which weighs beside the network's disc.
    sigma : float
        Standard deviation of its center and half-width there, in half-widths: less believes the region more, whose size
        is up to a tenth too large where a streak is long. It counts beside the network's covariance, inflated as
        `NetworkParameters.inflation` says; 0.05 beside that believes streaks too little
        (docs/log/network.md#disc-as-prior). It is that of a
        region with all of its worth, and grows with the inverse square of the share of it.
    round : float
        Agreement below which a region with a sharp rim is no disc: that of a square is 0.83, of other cards less.
    least_way : float
        Way from picture to picture, in half-widths, below which no region is looked for while a target is followed: a
        streak is no longer than that.
    min_half_width : float
        Half-width below which no region is looked for, px: a rim of a pixel or two is wide there.
    """

    inner: float = 0.6
    nearest: float = 1.4
    farthest: float = 1.9
    window: float = 2.0
    border: float = 1.6
    cells: int = 48
    pixel_noise: float = 2.0
    contrast: float = 1.0
    level: float = 0.4
    rounds: int = 3
    still: float = 1.0
    move: float = 0.5
    growth: float = 1.5
    lines: int = 48
    high: float = 0.7
    low: float = 0.2
    sharper: float = 0.25
    soft: float = 0.18
    softer: float = 0.25
    agreement: float = 0.8
    agrees: float = 0.88
    worth: float = 0.3
    sure: float = 0.5
    sigma: float = 0.03
    round: float = 0.85
    least_way: float = 0.25
    min_half_width: float = 5.0

    def __post_init__(self) -> None:
        for low, high in (("soft", "softer"), ("agreement", "agrees")):
            if not getattr(self, low) < getattr(self, high):
                raise ValueError(f"{low} must be less than {high}, got {getattr(self, low)} and {getattr(self, high)}")
        require(self, ("cells", "lines", "pixel_noise"), lambda value: value > 0, "positive")
        for name, most in (("cells", MOST_CELLS), ("lines", MOST_LINES)):
            if getattr(self, name) > most:
                raise ValueError(f"{name} is at most {most}, got {getattr(self, name)}")


class SoftRegion(NamedTuple):
    """A region, as the disc of its center and area.

    Attributes
    ----------
    x, y, half_width : float
        The disc, px.
    agreement : float
        Intersection over union of region and disc.
    swept : float
        The same with the disc that has the region's moments, swept along its longer axis.
    rim : float
        Width of its rim where that is sharper, in half-widths.
    """

    x: float
    y: float
    half_width: float
    agreement: float
    swept: float
    rim: float

    def worth(self, limits: SoftRegionParameters) -> float:
        """Say what the region is worth: nothing where its rim is sharp, or it is no disc."""
        softness = (self.rim - limits.soft) / (limits.softer - limits.soft)
        roundness = (max(self.agreement, self.swept) - limits.agreement) / (limits.agrees - limits.agreement)
        return limits.worth * min(max(softness, 0.0), 1.0) * min(max(roundness, 0.0), 1.0)

    def is_other(self, limits: SoftRegionParameters) -> bool:
        """Say whether it is seen that this is no disc: its rim is sharp, and the region another shape."""
        return self.rim < limits.soft and self.agreement < limits.round


_MEMORY = ThreadBlock(REGION_MEMORY)


def find_soft_region(image: Image, disc: Disc, limits: SoftRegionParameters) -> SoftRegion | None:
    """Find the region of the target around a disc, and measure its rim.

    Parameters
    ----------
    image : ndarray of shape (h, w, channels), uint8
    disc : tuple of three floats
        About where the target is: center and half-width, px.
    limits : SoftRegionParameters

    Returns
    -------
    SoftRegion or None
        None where nothing tells the inside from what is around it, or the region is not where it was expected.
    """
    if disc[2] < limits.min_half_width:
        return None
    block = _MEMORY.numbers
    memory = fields(block, REGION_MEMORY)
    store(memory.limits, limits)
    memory.x, memory.y, memory.half_width = disc
    if not find_region(channels_last(image), block):
        return None
    found = SoftRegion(*(float(getattr(memory, name)) for name in SoftRegion._fields))
    away = math.dist(found[:2], disc[:2]) / disc[2]
    if not 1.0 / limits.growth < found.half_width / disc[2] < limits.growth or away > limits.move:
        return None
    return found

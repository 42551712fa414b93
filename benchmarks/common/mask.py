"""What peers that make an HSV mask of the ball can be told, and what the search tries."""

import msgspec

from benchmarks.common.start import Choices

COLOR_CHOICES: Choices = {
    "hue": (8, 12, 16, 22, 30, 45, 60),
    "saturation": (0.15, 0.3, 0.45, 0.6, 0.75),
    "value": (0.1, 0.2, 0.35, 0.5),
}


class MaskParameters(msgspec.Struct, frozen=True):
    """The color's range, see `hsv_range`; side of the opening, px."""

    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 3


MASK_CHOICES: Choices = {**COLOR_CHOICES, "opening": (0, 3, 5)}


class RegionParameters(msgspec.Struct, frozen=True):
    """The color's range; side of the opening, px; half the region's side: reach * radius + margin, px."""

    hue: int = 15
    saturation: float = 0.5
    value: float = 0.4
    opening: int = 3
    reach: float = 1.45
    margin: float = 12.0


REGION_CHOICES: Choices = {**MASK_CHOICES, "reach": (1.1, 1.25, 1.45), "margin": (8.0, 12.0, 20.0)}

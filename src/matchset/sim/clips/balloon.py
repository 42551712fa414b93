"""The target: `Balloon`, a blue sphere with purple markers, or a ball with a pattern."""

import math
from typing import Literal, get_args

import msgspec

Color = tuple[float, float, float]
Vector = tuple[float, float, float]
Pattern = Literal["plain", "soccer", "basketball", "logo"]


class Balloon(msgspec.Struct, frozen=True, kw_only=True):
    """A sphere with round markers painted on it.

    Parameters
    ----------
    radius : float
        Radius of the sphere, m.
    marker : tuple of 3 floats or None
        Unit direction from the center of the sphere to the marker, camera frame. None: always toward the
        camera.
    marker_radius : float
        Half the straight distance across the marker, m. The marker is a spherical cap: it does not change
        the outline. 0: no marker.
    more_markers : tuple of (float, float, float)
        Directions to further markers of the same size and color, camera frame.
    color, marker_color : tuple of 3 floats
        BGR, 0 ... 255, of the surface in full diffuse light. White, gray and black balls have little color of their
        own: (225, 228, 230), (120, 122, 124), (28, 28, 30).
    pattern : str
        "plain"; "soccer": twelve pentagons and seams of another color; "basketball": seams; "logo": a star in a ring.
        A ball with a pattern has no marker.
    pattern_color : tuple of 3 floats
        BGR of the pattern.
    spin : float
        By how much the pattern turns per frame, rad.
    """

    radius: float = 0.14
    marker: Vector | None = None
    marker_radius: float = 0.03
    more_markers: tuple[Vector, ...] = ()
    color: Color = (205.0, 72.0, 22.0)
    marker_color: Color = (165.0, 36.0, 150.0)
    pattern: Pattern = "plain"
    pattern_color: Color = (30.0, 28.0, 28.0)
    spin: float = 0.05

    def __post_init__(self) -> None:
        if self.pattern not in get_args(Pattern):
            raise ValueError(f"a pattern is one of {', '.join(get_args(Pattern))}, got {self.pattern!r}")
        if not 0.0 < self.radius < math.inf:
            raise ValueError(f"a balloon's radius must be positive, got {self.radius} m")
        if not 0.0 <= self.marker_radius < self.radius:
            raise ValueError(f"a marker must be smaller than its balloon, got {self.marker_radius} m")
        for marker in (*self.more_markers, *(() if self.marker is None else (self.marker,))):
            if abs(math.hypot(*marker) - 1.0) > 1e-6:
                raise ValueError(f"a marker's direction must have length 1, got {marker}")

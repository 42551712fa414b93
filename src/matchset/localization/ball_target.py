"""What is known about the ball: `BallTarget`."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import check_number

MOST_MARKERS = 6  # format: rows of the workspace; which marker is which is found by trying
MIN_SEPARATION = 0.17  # geometry: rad between two markers, 10 degrees


class BallTarget(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A ball of known size with markers at known places.

    Parameters
    ----------
    diameter : float
        Of the ball, m. An error of 1 % is one of 1 % in range.
    markers : tuple of (float, float, float)
        Unit vectors from the ball's center to its markers, in the ball frame: z through marker 0, y down. One marker
        gives the pose of level vehicles, two or more give all; place them so that no two differences are alike.
    marker_diameter : float
        Straight across a marker, m; the markers lie on the ball like patches.

    Raises
    ------
    ValueError
        If the ball has no size, a marker is not smaller than the ball, a direction is no unit vector, there are more
        than six, or two are less than 10 degrees apart.
    """

    diameter: float = 0.28
    markers: tuple[tuple[float, float, float], ...] = ((0.0, 0.0, 1.0),)
    marker_diameter: float = 0.06

    def __post_init__(self) -> None:
        check_number("a ball's diameter", self.diameter)
        check_number("a marker's diameter", self.marker_diameter)
        try:
            lengths = [math.hypot(*marker) if len(marker) == 3 else 0.0 for marker in self.markers]
        except TypeError:
            raise TypeError(f"markers must be unit vectors of 3 numbers, got {self.markers!r:.60}") from None
        if not 0.0 < self.diameter < math.inf:
            raise ValueError(f"a ball's diameter must be positive, got {self.diameter} m")
        if not 0.0 < self.marker_diameter < self.diameter:
            raise ValueError(
                f"a marker must be smaller than its ball of {self.diameter} m, got {self.marker_diameter} m"
            )
        if len(self.markers) > MOST_MARKERS:
            raise ValueError(f"a ball has at most {MOST_MARKERS} markers, got {len(self.markers)}")
        for k, marker in enumerate(self.markers):
            if not abs(lengths[k] - 1.0) <= 1e-6:
                raise ValueError(f"markers must be unit vectors of 3 numbers, got {marker}")
            for other in self.markers[:k]:
                if math.dist(marker, other) < 2.0 * math.sin(0.5 * MIN_SEPARATION):
                    raise ValueError(f"two markers must be 10 degrees apart or more, got {other} and {marker}")

    @property
    def radius(self) -> float:
        """Of the ball, m."""
        return 0.5 * self.diameter

    @property
    def marker_distance(self) -> float:
        """From the ball's center to the middle of a marker's rim, m: a little less than the radius."""
        return 0.5 * math.sqrt(self.diameter**2 - self.marker_diameter**2)

    @property
    def directions(self) -> npt.NDArray[np.float64]:
        """The markers as an array, (m, 3)."""
        return np.array(self.markers, np.float64).reshape(-1, 3)

"""What is known about the ball: `BallTarget`."""

import math

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.numeric.arguments import check_number

MOST_MARKERS = 6  # format: rows of the workspace; which marker is which is found by trying
MIN_SEPARATION = 0.17  # geometry: rad between two markers, 10 degrees
MARKER_DIAMETER = 0.06  # format: m, of markers whose size is not said: those of the paper's pictures
NAME_THEM = "name them, for one in front BallTarget(0.28, markers=((0, 0, 1),), marker_diameter=0.06)"


class BallTarget(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A ball of known size; if it has markers, at known places.

    Parameters
    ----------
    diameter : float
        Of the ball, m. An error of 1 % is one of 1 % in range, and no picture shows it: see `diameter_sigma`.
    markers : tuple of (float, float, float)
        Unit vectors from the ball's center to its markers, in the ball frame: z through marker 0, y down. None by
        default: the ball has a position, no rotation. One marker gives the pose of level vehicles, two or more give
        all; place them so that no two differences are alike.
    marker_diameter : float
        Straight across a marker, m; the markers lie on the ball like patches. 0 without markers; 0.06 where markers
        are named and this is not.
    diameter_sigma : float
        Standard deviation of `diameter`, m; that of the markers goes with it. It is part of the covariance of every
        pose. 0 by default: the diameter is taken as exact.

    Raises
    ------
    ValueError
        If the ball has no size, a marker is not smaller than the ball, a direction is no unit vector, there are more
        than six, two are less than 10 degrees apart, markers have a size and no place, or the standard deviation is
        negative or as large as the diameter.
    """

    diameter: float = 0.28
    markers: tuple[tuple[float, float, float], ...] = ()
    marker_diameter: float = 0.0
    diameter_sigma: float = 0.0

    def __post_init__(self) -> None:
        check_number("a ball's diameter", self.diameter)
        check_number("a marker's diameter", self.marker_diameter)
        check_number("diameter_sigma", self.diameter_sigma)
        if not 0.0 < self.diameter < math.inf:
            raise ValueError(f"a ball's diameter must be positive, got {self.diameter} m")
        if not 0.0 <= self.diameter_sigma < self.diameter:
            raise ValueError(
                f"diameter_sigma must be 0 or more, and less than the diameter of {self.diameter} m, "
                f"got {self.diameter_sigma} m"
            )
        _check_directions(self.markers)
        if self.markers and self.marker_diameter == 0.0:
            msgspec.structs.force_setattr(self, "marker_diameter", MARKER_DIAMETER)
        if not self.markers and self.marker_diameter != 0.0:
            raise ValueError(f"no marker is named, and marker_diameter got {self.marker_diameter} m: {NAME_THEM}")
        if self.markers and not 0.0 < self.marker_diameter < self.diameter:
            raise ValueError(
                f"a marker must be smaller than its ball of {self.diameter} m, got {self.marker_diameter} m: "
                "say marker_diameter"
            )

    def require_markers(self, who: str) -> None:
        """Refuse a ball without markers.

        Parameters
        ----------
        who : str
            What needs them, in words.

        Raises
        ------
        ValueError
            If there is none; says how to name one.
        """
        if not self.markers:
            raise ValueError(f"{who} needs a ball with markers, got one of {self.diameter} m without: {NAME_THEM}")

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


def _check_directions(markers: tuple[tuple[float, float, float], ...]) -> None:
    """Refuse what are no directions, too many of them, or two that are all but the same."""
    try:
        lengths = [math.hypot(*marker) if len(marker) == 3 else 0.0 for marker in markers]
    except TypeError:
        raise TypeError(f"markers must be unit vectors of 3 numbers, got {markers!r:.60}") from None
    if len(markers) > MOST_MARKERS:
        raise ValueError(f"a ball has at most {MOST_MARKERS} markers, got {len(markers)}")
    for k, marker in enumerate(markers):
        if not abs(lengths[k] - 1.0) <= 1e-6:
            raise ValueError(f"markers must be unit vectors of 3 numbers, got {marker}")
        for other in markers[:k]:
            if math.dist(marker, other) < 2.0 * math.sin(0.5 * MIN_SEPARATION):
                raise ValueError(f"two markers must be 10 degrees apart or more, got {other} and {marker}")


# geometry: the balloon of the paper's pictures
BALLOON = BallTarget(0.28, markers=((0.0, 0.0, 1.0),), marker_diameter=MARKER_DIAMETER)
"""The balloon that a follower's neighbor carries, with its one marker in front."""


class NeighborBall(BallTarget, frozen=True):
    """A neighbor's ball in the settings of a flight: what they leave out is as on `BALLOON`, its marker too."""

    markers: tuple[tuple[float, float, float], ...] = BALLOON.markers
    marker_diameter: float = BALLOON.marker_diameter

    def __post_init__(self) -> None:
        if not self.markers:  # said in so many words: then there is none to have a size
            msgspec.structs.force_setattr(self, "marker_diameter", 0.0)
        super().__post_init__()

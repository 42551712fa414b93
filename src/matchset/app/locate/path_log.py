"""Where the ball was during a run, kept for its picture: `Course`."""

import math
from array import array

import numpy as np
import numpy.typing as npt

from matchset.app.locate.loop import Sighting
from matchset.localization.pose import Pose

Floats = npt.NDArray[np.float64]

_NUMBERS = 8  # a frame


class Course:
    """Times, positions and their spread, frame by frame; 64 bytes a frame, so a camera may run for hours.

    Attributes
    ----------
    any_found : bool
        Whether the ball was placed in any frame.
    """

    def __init__(self) -> None:
        self._numbers = array("d")
        self.any_found = False

    def add(self, sighting: Sighting) -> None:
        """Take note of a frame."""
        pose = sighting.pose
        if isinstance(pose, Pose):
            self.any_found = True
            spread = pose.covariance
            place = (*pose.position.tolist(), *np.diag(spread)[:3].tolist(), float(spread[0, 2]))
        else:
            place = (math.nan,) * (_NUMBERS - 1)
        self._numbers.extend((sighting.row.time, *place))

    @property
    def _table(self) -> Floats:
        return np.array(self._numbers, np.float64).reshape(-1, _NUMBERS)

    @property
    def time(self) -> Floats:
        """Since the first frame, (n,), s."""
        time = self._table[:, 0]
        return np.asarray(time - time[:1])

    @property
    def position(self) -> Floats:
        """Of the ball in the camera frame, (n, 3), m; NaN where it was not placed."""
        return self._table[:, 1:4]

    @property
    def std(self) -> Floats:
        """Standard deviations of the position, (n, 3), m; NaN where it was not placed."""
        return np.sqrt(self._table[:, 4:7])

    @property
    def level_spread(self) -> Floats:
        """Covariance of x and z, (n, 2, 2), m^2."""
        table = self._table
        return table[:, (4, 7, 7, 6)].reshape(-1, 2, 2)

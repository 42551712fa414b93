"""What a rendered frame really shows: `Truth`."""

import msgspec

from matchset.shapes.circle import Circle
from matchset.sim.clips.outline import Outline


class Truth(msgspec.Struct, frozen=True, kw_only=True):
    """What a frame of a clip really shows, in the middle of its exposure.

    Parameters
    ----------
    index : int
        The frame's index.
    circle : Circle or None
        Least-squares circle to the exact outline, px; interlaced: the mean of the two fields' circles. None
        where nothing of the ball can be seen.
    visible : bool
        Some of the ball can be seen.
    share : float
        Share of the disc that lies in the picture and behind nothing, 0 ... 1, good to 0.01.
    outline : Outline or None
        The exact ellipse and the projected center at the middle of the frame's exposure, hidden or not;
        None without a ball.
    position : tuple of 3 floats or None
        Center of the ball in the camera frame, m; None without a ball.
    """

    index: int
    circle: Circle | None
    visible: bool
    share: float
    outline: Outline | None
    position: tuple[float, float, float] | None

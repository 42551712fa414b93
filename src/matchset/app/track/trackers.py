"""Which tracker begins where: `trackers_for`."""

from collections.abc import Callable
from typing import Any

from matchset.app.patience import if_slow
from matchset.app.track.loop import Follower
from matchset.app.track.target_options import Target
from matchset.image.frame import Frame
from matchset.shapes.circle import Circle
from matchset.tracking.tracker import Tracker

COMPILING = "compiling kernels (only once on this machine) ..."


def trackers_for(target: Target, points: int, family: type[Any] = Circle) -> Callable[[Frame], Follower | None]:
    """Make the trackers; a click counts in its own frame, so the tracker begins anew there.

    Parameters
    ----------
    target : Target
        What to follow.
    points : int
        Size of the match-set.
    family : type
        The family of shapes.

    Returns
    -------
    callable
        Asked before each frame: a new tracker to go on with, or None to keep the one there is.
    """
    with if_slow(COMPILING):
        searching = Tracker(family, target.color, points=points)
        clicked = None if target.start is None else Tracker(family, target.color, points=points, start=target.start)
    begun = False

    def follower_at(frame: Frame) -> Follower | None:
        nonlocal begun, clicked
        if clicked is not None and frame.index >= target.frame:
            begun, chosen, clicked = True, clicked, None
            return chosen
        if not begun:
            begun = True
            return searching
        return None

    return follower_at

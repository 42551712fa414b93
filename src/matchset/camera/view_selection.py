"""Which views of a board are worth calibrating with: the sharp ones that differ from each other."""

import numpy as np

from matchset.camera.board import View

TOO_ALIKE = 0.02
"""Two views count as one if their corners lie closer than this, in widths of the picture. Less keeps more views of a
video and takes longer; more throws away what a patient hand has shown."""
TOO_BLURRED = 1.7
"""Blurred by more than this, in units of the sharper half's median, a view is left out. Less demands a stiller hand."""
MOST = 40
"""As many views are used at most; the time of a calibration grows with them, its accuracy hardly."""


def select_views(views: list[View], width: int, most: int = MOST) -> list[View]:
    """Choose the views to calibrate with.

    Parameters
    ----------
    views : list of View
        All that were found.
    width : int
        Of the picture, px.
    most : int, default 40
        How many at most.

    Returns
    -------
    list of View
        In the order of their frames.
    """
    if not views:
        return []
    sharpest = sorted(views, key=lambda view: view.blur)
    limit = TOO_BLURRED * max(sharpest[(len(sharpest) - 1) // 4].blur, 0.5)
    kept: list[View] = []
    for view in sharpest:
        if view.blur <= limit and all(difference(view, other) > TOO_ALIKE * width for other in kept):
            kept.append(view)
    return sorted(_spread(kept, most), key=lambda view: view.index)


def difference(one: View, other: View) -> float:
    """How far the corners of two views lie apart.

    Parameters
    ----------
    one, other : View

    Returns
    -------
    float
        Mean distance of the corners that both show, px; infinite if there are none. A chessboard may be found either
        way round; the nearer counts.
    """
    _, mine, its = np.intersect1d(one.corners, other.corners, assume_unique=True, return_indices=True)
    if not len(mine):
        return float("inf")
    straight = np.linalg.norm(one.pixels[mine] - other.pixels[its], axis=1).mean()
    turned = np.linalg.norm(one.pixels[mine] - other.pixels[its][::-1], axis=1).mean()
    return float(min(straight, turned))


def _spread(views: list[View], most: int) -> list[View]:
    """Take the view that differs most from those taken, again and again."""
    if len(views) <= most:
        return views
    taken, left = [views[0]], views[1:]
    apart = np.array([difference(views[0], view) for view in left])
    while len(taken) < most:
        farthest = int(np.argmax(np.where(np.isfinite(apart), apart, 1e9)))
        taken.append(left[farthest])
        apart = np.minimum(apart, [difference(left[farthest], view) for view in left])
        apart[farthest] = -1.0
    return taken

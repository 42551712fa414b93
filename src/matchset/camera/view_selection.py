"""Chooses the views of a board to calibrate with: sharp ones that differ from each other."""

import msgspec
import numpy as np

from matchset.camera.board import BoardView


class ViewSelectionParameters(msgspec.Struct, frozen=True, kw_only=True):
    """Which views of a board are used.

    All were chosen by hand; tests/camera/test_calibrate.py would show a change.

    Parameters
    ----------
    min_difference : float, default 0.02
        Two views are the same if their corners lie closer than this, in widths of the image. Less keeps more views of a
        video and takes longer; more throws away views that do differ.
    max_blur : float, default 1.7
        A view is left out if its blur is above this, in units of the quarter that is sharpest. Less demands a stiller
        hand.
    min_blur_px : float, default 0.5
        That unit is at least this: below it blur is not measured well.
    max_views : int, default 40
        The time of a calibration grows with the views, its accuracy hardly.
    """

    min_difference: float = 0.02
    max_blur: float = 1.7
    min_blur_px: float = 0.5
    max_views: int = 40


def select_views(
    views: list[BoardView], width: int, parameters: ViewSelectionParameters | None = None
) -> list[BoardView]:
    """Choose the views to calibrate with.

    Parameters
    ----------
    views : list of BoardView
        All that were found.
    width : int
        Of the picture, px.
    parameters : ViewSelectionParameters, optional

    Returns
    -------
    list of BoardView
        In the order of their frames.
    """
    if not views:
        return []
    limits = parameters or ViewSelectionParameters()
    sharpest = sorted(views, key=lambda view: view.blur)
    limit = limits.max_blur * max(sharpest[(len(sharpest) - 1) // 4].blur, limits.min_blur_px)
    kept: list[BoardView] = []
    for view in sharpest:
        if view.blur <= limit and all(difference(view, other) > limits.min_difference * width for other in kept):
            kept.append(view)
    return sorted(_most_different(kept, limits.max_views), key=lambda view: view.index)


def difference(one: BoardView, other: BoardView) -> float:
    """How far the corners of two views lie apart.

    Parameters
    ----------
    one, other : BoardView

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


def _most_different(views: list[BoardView], most: int) -> list[BoardView]:
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

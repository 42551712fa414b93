"""Flat convex things drawn over a picture with exact coverage along rows."""

import numpy as np
import numpy.typing as npt

from matchset.sim.rendering.renderer import ALL_ROWS, Picture, Rows

Array = npt.NDArray[np.float64]
FINE = 16  # lines by which a row of pixels is sampled


def coverage(corners: Array, left: int, right: int, rows: npt.NDArray[np.int64]) -> Array:
    """Share of each pixel that a convex polygon covers.

    Along each of 16 lines of a row the covered length is exact.

    Parameters
    ----------
    corners : ndarray of shape (k, 2), float64
        In order around it, px.
    left, right : int
        First column, and the one after the last.
    rows : ndarray of shape (m,), int64

    Returns
    -------
    ndarray of shape (m, right - left), float64
        0 ... 1.
    """
    y = (rows[:, None] + (np.arange(FINE) + 0.5) / FINE - 0.5).reshape(-1, 1)
    (x0, y0), (x1, y1) = corners.T, np.roll(corners, -1, axis=0).T
    crosses = (y0 <= y) != (y1 <= y)
    flat = y1 == y0
    x = x0 + (y - y0) * (x1 - x0) / np.where(flat, 1.0, y1 - y0)
    begin = np.where(crosses, x, np.inf).min(axis=1)[:, None]
    end = np.where(crosses, x, -np.inf).max(axis=1)[:, None]
    columns = np.arange(left, right, dtype=np.float64)
    length = np.clip(np.minimum(end, columns + 0.5) - np.maximum(begin, columns - 0.5), 0.0, 1.0)
    found: Array = length.reshape(len(rows), FINE, -1).mean(axis=1)
    return found


def draw_flat(picture: Picture, outlines: list[Array], look: npt.ArrayLike, rows: Rows = ALL_ROWS) -> None:
    """Blend a convex thing over some rows of a picture, in place.

    Parameters
    ----------
    picture : ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255; changed.
    outlines : list of ndarray of shape (k, 2)
        Its outline in each sub-exposure, px.
    look : array_like of shape (3,) or (h, w, 3)
        Its color, or the picture that shows inside it.
    rows : Rows
        Which rows to draw.
    """
    height, width = picture.shape[:2]
    every = np.concatenate(outlines)
    left, top = np.maximum(np.floor(every.min(axis=0)).astype(int) - 1, 0).tolist()
    right, bottom = np.minimum(np.ceil(every.max(axis=0)).astype(int) + 2, (width, height)).tolist()
    chosen = np.arange(top + (rows.start - top) % rows.step, bottom, rows.step)
    if left >= right or len(chosen) == 0:
        return
    cover = sum(coverage(outline, left, right, chosen) for outline in outlines) / len(outlines)
    color = np.asarray(look, np.float32)
    if color.ndim == 3:
        color = color[chosen, left:right]
    part = picture[chosen, left:right]
    picture[chosen, left:right] = part + np.asarray(cover, np.float32)[:, :, None] * (color - part)

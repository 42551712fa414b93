"""The paper to the letter: Eq. 1-4, Eq. 10 and Alg. 1-3 of Epstein & Feldman in plain NumPy.

Slow and readable: the oracle of the fast path's tests, and a row of the benchmark.

- Eq. 1: `white_within`, `edge_difference`; `edge_points`, the masks `E` of four directions; `union`, E(M)
- Eq. 2-4: `near_circle`, E(M, C); `arc_segments`, A(M, p); `match_set`, S(M, C). They take `E` in place of
  `M`: they use nothing else of the image, and it is computed once
- Alg. 2, 3, 1: `init_circle`, `track_circle`, `circle_detection`; Eq. 10: `error`

Images `M` are (h, w), bool or 0/1 (whatever is not 0 is white); x is the column, y the row, growing downward.
Pixels outside the picture are black, so a white area cut by the border has edges there. Sets of pixels are
(h, w) bool masks; `points` turns one into (n, 2) float64, x and y in px.

Where the print cannot be right, or does not say:

- Eq. 3 says "black area side is closer to p"; its own four cases say white, as it must be for the center of a
  white disc. It leaves out the points level with p, or exactly above or below: they count in both neighboring
  cases, and p itself in all four.
- Alg. 3, line 3 takes triples h'[3i..3i+2] of the set H' without giving its order. Neighboring pixels have
  almost arbitrary circumcenters: in the order of rows or of angles a clean disc is lost within a few frames.
  Here the order is such that a third of the set, by angle, lies between the points of a triple.
- Alg. 3, line 7 keeps {h' in H' : |h' - p_C| in [r - 1, r + 1]}. A part of H' can only shrink: of the 200
  match points of a clean moving disc fewer than three are left after 80 frames. Here it is all edge points
  that lie within 1 px: S(M, C') with eps = 1.
- Alg. 1 would track image 0 from C[-1]; here image 0 is for INITCIRCLE and the others for TRACKCIRCLE.
- The "validation parts" left out of Alg. 3: without an answer the last circle and match-set stay as they are.
"""
# ruff: noqa: N803, N806  (M, E, A, C, H, R, S and T are the paper's names)

import itertools
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from matchset.shapes.circle import Circle

Direction = Literal["right", "left", "upper", "lower"]
Image = npt.NDArray[Any]
Counts = npt.NDArray[np.int64]
Mask = npt.NDArray[np.bool_]
Points = npt.NDArray[np.float64]
Center = tuple[float, float]
Edges = dict[Direction, Mask]
Found = tuple[Circle, Points]
# geometry: from a pixel to its neighbor
STEP: dict[Direction, tuple[int, int]] = {"right": (1, 0), "left": (-1, 0), "upper": (0, -1), "lower": (0, 1)}


@dataclass(frozen=True)
class Search:
    """The circles that INITCIRCLE tries; what is None is tried exhaustively, as in the paper.

    Parameters
    ----------
    x, y : sequence of float, optional
        Centers, px; by default every pixel of the picture.
    radius : sequence of float, optional
        Radii, px, greater than 0; by default 1 to the longer side of the picture.
    """

    x: Sequence[float] | None = None
    y: Sequence[float] | None = None
    radius: Sequence[float] | None = None


ALL = Search()


def white_within(M: Image, margin: int) -> dict[Direction, Counts]:
    """Count the white pixels within `margin` of each pixel (Epstein & Feldman, Eq. 1).

    Parameters
    ----------
    M : (h, w) bool or 0/1
        The image after color filtering.
    margin : int
        Pixels looked at on each side, px, at least 1; the expected width of an edge.

    Returns
    -------
    dict of direction to (h, w) int64
        `|I(p, margin, dir)|`. `upper` is the rows [y - margin, y]; p itself is in all four.
    """
    if M.ndim != 2:
        raise ValueError(f"an image of Eq. 1 has two axes (h, w), got shape {M.shape}")
    if margin < 1:
        raise ValueError(f"margin must be at least 1 px, got {margin}")
    height, width = M.shape
    padded = np.pad(M.astype(bool).astype(np.int64), margin)  # outside is black
    count = {dir_: np.zeros((height, width), np.int64) for dir_ in STEP}
    for dir_, (dx, dy) in STEP.items():
        for k in range(margin + 1):
            top, left = margin + k * dy, margin + k * dx
            count[dir_] += padded[top : top + height, left : left + width]
    return count


def edge_difference(M: Image, margin: int) -> dict[Direction, Counts]:
    """Subtract the white counts on the two sides (Epstein & Feldman, Eq. 1, left-hand side).

    Arguments and answer have the form of those of `white_within`: -margin to margin at each pixel.
    """
    white = white_within(M, margin)
    return {
        "right": white["left"] - white["right"],
        "left": white["right"] - white["left"],
        "upper": white["lower"] - white["upper"],
        "lower": white["upper"] - white["lower"],
    }


def edge_points(M: Image, margin: int, threshold: float) -> Edges:
    """Find the edge points of each direction (Epstein & Feldman, Eq. 1).

    Parameters
    ----------
    M, margin
        As in `white_within`.
    threshold : float
        The two counts must differ by more than this many pixels, 0 or more. `margin - 1` keeps the two pixels
        beside a clean boundary; a small one up to `margin` pixels on each side, which ties down no circle.

    Returns
    -------
    dict of direction to (h, w) bool
        A `right` edge has its white on the left and black on its right, and alike.
    """
    if not threshold >= 0:
        raise ValueError(f"threshold must not be negative, got {threshold}")
    return {dir_: difference > threshold for dir_, difference in edge_difference(M, margin).items()}


def union(E: Edges) -> Mask:
    """Unite the edge points of the four directions: E(M)."""
    return E["right"] | E["left"] | E["upper"] | E["lower"]


def points(mask: Mask) -> Points:
    """List the pixels of a mask, row by row: (n, 2) float64, x and y in px."""
    return np.argwhere(mask)[:, ::-1].astype(np.float64)


def near_circle(E: Edges, C: Circle, eps: float) -> Mask:
    """Keep the edge points r - eps to r + eps from the center: E(M, C) (Epstein & Feldman, Eq. 2)."""
    height, width = E["right"].shape
    distance = np.hypot(np.arange(width) - C.x, np.arange(height)[:, np.newaxis] - C.y)
    ring: Mask = (distance >= C.radius - eps) & (distance <= C.radius + eps)
    return union(E) & ring


def arc_segments(E: Edges, p: Center) -> Mask:
    """Keep the edge points whose white side faces p: A(M, p) (Epstein & Feldman, Eq. 3)."""
    height, width = E["right"].shape
    return _facing(E, np.arange(width), np.arange(height)[:, np.newaxis], p)


def _facing(E: Edges, x: Image, y: Image, p: Center) -> Mask:
    """Join the four cases of Eq. 3, each of which appears in two of them, for pixels at `x`, `y`."""
    facing: Mask = (
        (E["left"] & (x <= p[0])) | (E["right"] & (x >= p[0])) | (E["upper"] & (y <= p[1])) | (E["lower"] & (y >= p[1]))
    )
    return facing


def match_set(E: Edges, C: Circle, eps: float) -> Mask:
    """Intersect E(M, C) and A(M, p_C): the match-set S(M, C) (Epstein & Feldman, Eq. 4)."""
    return near_circle(E, C, eps) & arc_segments(E, (C.x, C.y))


def _distances(E: Edges, centers: Iterable[Center]) -> Iterator[tuple[Center, Points]]:
    """Yield each center p with the ascending distances of A(M, p) from it."""
    x, y = points(union(E)).T
    E_at = {dir_: mask[union(E)] for dir_, mask in E.items()}
    for p in centers:
        A = _facing(E_at, x, y, p)
        yield p, np.sort(np.hypot(x[A] - p[0], y[A] - p[1]))


def init_circle(
    M: Image, margin: int = 3, threshold: float = 2, eps: float = 0.5, search: Search = ALL
) -> Found | None:
    """Find the circle with the largest match-set (Epstein & Feldman, Alg. 2, INITCIRCLE).

    Parameters
    ----------
    M, margin, threshold
        As in `edge_points`.
    eps : float
        Half the width of the ring of Eq. 2, px, between 0 and 1.
    search : Search
        The circles to try.

    Returns
    -------
    (Circle, (m, 2) float64) or None
        The circle and its match-set, px. Of equally good circles the first in the order of the paper's loop
        (x, then y, then r). None where no circle has any match point, as in a picture without edges.
    """
    if not 0 < eps < 1:
        raise ValueError(f"eps must be between 0 and 1 px, got {eps}")
    xs = range(M.shape[1]) if search.x is None else search.x
    ys = range(M.shape[0]) if search.y is None else search.y
    radii = np.array(range(1, max(M.shape) + 1) if search.radius is None else search.radius, np.float64)
    E = edge_points(M, margin, threshold)
    best, C = 0, None
    for p, distance in _distances(E, itertools.product(xs, ys)):
        if len(distance) > best:
            sizes = np.searchsorted(distance, radii + eps, "right") - np.searchsorted(distance, radii - eps)
            if sizes.max(initial=0) > best:
                best, C = int(sizes.max()), Circle(*map(float, (*p, radii[sizes.argmax()])))
    return None if C is None else (C, points(match_set(E, C, eps)))


def track_circle(M: Image, H: Points, R: Circle, margin: int = 3, threshold: float = 2) -> Found:
    """Follow a circle into the next image (Epstein & Feldman, Alg. 3, TRACKCIRCLE).

    Each point of the match-set moves to the closest point of A(M, p_R). The circumcenters of triples of them
    are averaged to the center, the distances from it to the radius. On lines 3 and 7 see the module's text.

    Parameters
    ----------
    M, margin, threshold
        As in `edge_points`.
    H, R : (m, 2) float64, Circle
        The last match-set and circle, px.

    Returns
    -------
    Circle, (m, 2) float64
        The new circle and its match-set, px. `R` and `H` themselves without an answer: H or A(M, p_R) empty,
        all triples collinear, or fewer than three points within 1 px of the new circle.
    """
    E = edge_points(M, margin, threshold)
    A = points(arc_segments(E, (R.x, R.y)))
    if len(A) == 0 or len(H) == 0:
        return R, H
    H_new = np.unique([_closest_point(h, A) for h in H], axis=0)
    H_new = H_new[np.argsort(np.arctan2(H_new[:, 1] - R.y, H_new[:, 0] - R.x), kind="stable")]
    third = len(H_new) // 3
    T = circumcenters(H_new[:third], H_new[third : 2 * third], H_new[2 * third : 3 * third])
    if len(T) == 0:
        return R, H
    x, y = T.mean(axis=0)
    C = Circle(float(x), float(y), float(np.hypot(H_new[:, 0] - x, H_new[:, 1] - y).mean()))
    S = points(match_set(E, C, 1.0))
    return (C, S) if len(S) >= 3 else (R, H)


def _closest_point(h: Points, A: Points) -> Points:
    """CLOSESTPOINT(h, A); of equally close points the first."""
    nearest: Points = A[np.argmin((A[:, 0] - h[0]) ** 2 + (A[:, 1] - h[1]) ** 2)]
    return nearest


def circumcenters(s1: Points, s2: Points, s3: Points) -> Points:
    """Find CENTER(s1, s2, s3) of each triple, (k, 2) float64 px each; collinear triples are left out."""
    (bx, by), (cx, cy) = (s2 - s1).T, (s3 - s1).T
    twice_cross = 2.0 * (bx * cy - by * cx)
    solvable = twice_cross != 0.0
    b2, c2 = bx * bx + by * by, cx * cx + cy * cy
    offset = np.stack([cy * b2 - by * c2, bx * c2 - cx * b2], axis=1)
    centers: Points = s1[solvable] + offset[solvable] / twice_cross[solvable, np.newaxis]
    return centers


def circle_detection(
    images: Iterable[Image], margin: int = 3, threshold: float = 2, eps: float = 0.5, search: Search = ALL
) -> Iterator[Circle | None]:
    """Yield a circle for each image (Epstein & Feldman, Alg. 1, CIRCLEDETECTION).

    INITCIRCLE on the first image, TRACKCIRCLE on the others. Where INITCIRCLE finds none, None is yielded and
    it is tried again on the next image; afterwards none is ever lost: without edges the last circle stays.

    Parameters are those of `init_circle`; `images` is an iterable of its `M`.
    """
    found: Found | None = None
    for M in images:
        if found is None:
            found = init_circle(M, margin, threshold, eps, search)
        else:
            C, S = found
            found = track_circle(M, S, C, margin, threshold)
        yield None if found is None else found[0]


def error(C: Circle, C_star: Circle) -> float:
    """Sum the differences in x, y and r, px; below 5 a detection is valid (Epstein & Feldman, Eq. 10)."""
    return abs(C.x - C_star.x) + abs(C.y - C_star.y) + abs(C.radius - C_star.radius)

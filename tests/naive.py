"""Slow and obvious twins of the equations, in sets of pixels as the paper prints them, for the tests."""

from typing import Any

import numpy as np
import numpy.typing as npt

from matchset import reference
from matchset.reference import Direction, Mask

Pixels = set[tuple[int, int]]
ORDER: tuple[Direction, ...] = ("right", "left", "upper", "lower")
OPPOSITE: dict[Direction, Direction] = {"right": "left", "left": "right", "upper": "lower", "lower": "upper"}


def disc(x: float, y: float, radius: float, shape: tuple[int, int] = (48, 48)) -> Mask:
    rows, columns = np.indices(shape)
    inside: Mask = (columns - x) ** 2 + (rows - y) ** 2 <= radius**2
    return inside


def pixels(mask: Mask) -> Pixels:
    return {(int(x), int(y)) for x, y in reference.points(mask)}


def white(image: npt.NDArray[Any], x: int, y: int, margin: int, direction: Direction) -> Pixels:
    """Eq. 1 as printed: a set over all pixels of the image."""
    windows = {
        "right": lambda a, b: x <= a <= x + margin and b == y,
        "left": lambda a, b: x - margin <= a <= x and b == y,
        "upper": lambda a, b: a == x and y - margin <= b <= y,
        "lower": lambda a, b: a == x and y <= b <= y + margin,
    }
    height, width = image.shape
    return {
        (a, b)
        for a in range(width)
        for b in range(height)
        if image[b, a] == 1 and windows[direction](a, b)
    }  # fmt: skip


def edges(image: npt.NDArray[Any], margin: int, threshold: float) -> dict[Direction, Pixels]:
    edges: dict[Direction, Pixels] = {direction: set() for direction in ORDER}
    for y, x in np.ndindex(*image.shape):
        for direction in ORDER:
            behind = white(image, x, y, margin, OPPOSITE[direction])
            before = white(image, x, y, margin, direction)
            if len(behind) - len(before) > threshold:
                edges[direction].add((x, y))
    return edges


def arc_segments(edges: dict[Direction, Pixels], p: tuple[float, float]) -> Pixels:
    """Eq. 3's four cases; the points level with p, above or below it count in both neighboring cases."""
    arcs: Pixels = set()
    for e in set().union(*edges.values()):
        above, below, right, left = p[1] <= e[1], p[1] >= e[1], p[0] >= e[0], p[0] <= e[0]
        cases = [
            (above and right, edges["left"] | edges["lower"]),
            (above and left, edges["right"] | edges["lower"]),
            (below and right, edges["left"] | edges["upper"]),
            (below and left, edges["right"] | edges["upper"]),
        ]
        if any(applies and e in allowed for applies, allowed in cases):
            arcs.add(e)
    return arcs

"""Draw the gallery of shapes: `python docs/pictures/shapes.py`, from the root of the repository."""

import math
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import numpy.typing as npt

import matchset as ms
from matchset.app.drawing.annotate import draw_points, draw_shape
from matchset.app.drawing.contact_sheet import label
from matchset.shapes.shape import outline
from matchset.sim.clips.shape_clip import ShapeClip

TILE, ROOM, GAP, COLUMNS = 200, 1.5, 5, 4
LETTERS, QUALITY = 19, 88  # px, to be read where the picture is as wide as a phone; WebP
NAMES = ("ellipse", "rectangle", "quadrilateral", "triangle", "octagon", "egg", "half disc", "square, bad link")
LAST = 12  # frame that is shown
FRAME = ((-1.5, -1.0), (1.5, -1.0), (1.5, 1.0), (-1.5, 1.0))
BLUE, RED, GREEN, YELLOW = (205.0, 88.0, 30.0), (40.0, 40.0, 205.0), (70.0, 150.0, 50.0), (40.0, 190.0, 225.0)


def regular(sides: int) -> list[tuple[float, float]]:
    """Corners of a regular polygon."""
    turns = [2.0 * math.pi * (k + 0.5) / sides for k in range(sides)]
    return [(math.cos(t), math.sin(t)) for t in turns]


def scenes() -> list[tuple[type[Any], ShapeClip]]:
    """Families, each with a clip of a shape of it."""
    egg = ms.Convex.of(lambda t: 10.0 + 2.0 * np.cos(t) + 0.7 * np.cos(2.0 * t))
    sign, triangle = ms.Polygon.of(regular(8)), ms.Polygon.of(regular(3))
    half_disc = [(math.cos(t), math.sin(t) - 0.42) for t in np.linspace(0.0, math.pi, 120).tolist()]
    half = ms.Convex.of(half_disc, motion="affine")
    oval = [(1.5 * x, y) for x, y in regular(180)]
    return [
        (ms.Ellipse, clip(oval, GREEN, 101)),
        (ms.Rectangle, clip(FRAME, BLUE, 102, hidden=1.0 / 3.0)),
        (ms.Quadrilateral, clip(FRAME, YELLOW, 103, tilt=0.6)),
        (triangle, clip(regular(3), RED, 104)),
        (sign, clip(regular(8), RED, 105, hidden=0.25)),
        (egg, clip(outline(egg(0.0, 0.0, 1.0, 0.0)).tolist(), YELLOW, 106)),
        (half, clip(half_disc, GREEN, 107)),
        (ms.Rectangle, clip(regular(4), BLUE, 108, preset="bad")),
    ]


def clip(corners: Any, color: tuple[float, float, float], seed: int, **changes: Any) -> ShapeClip:
    """Sequence of a shape of a color."""
    points = tuple((float(x), float(y)) for x, y in corners)
    return ShapeClip(corners=points, color=color, seed=seed, frames=LAST + 1, sizes=(55.0, 80.0), **changes)


def tile(family: type[Any], shown: ShapeClip) -> npt.NDArray[np.uint8]:
    """Follow a shape from one click; cut it out of the last frame, with its outline and match-set."""
    tracker: ms.Tracker[Any] | None = None
    for frame, _ in shown:
        if tracker is None:
            color = ms.ColorModel.pick(frame.image, *shown.first_click, ball=False)
            tracker = ms.Tracker(family, color, start=shown.first_click)
        answer = tracker.update(frame)
    image = frame.image.copy()
    if isinstance(answer, ms.Track):
        draw_shape(image, answer.shape)
        draw_points(image, answer.match_set)
    points = shown.outline(float(LAST))
    middle, half = 0.5 * (points.min(axis=0) + points.max(axis=0)), 0.5 * ROOM * float(np.ptp(points, axis=0).max())
    left, top = (int(np.clip(m - half, 0, n - 2 * half)) for m, n in zip(middle, image.shape[1::-1], strict=True))
    part = image[top : top + int(2 * half), left : left + int(2 * half)]
    return np.asarray(cv2.resize(part, (TILE, TILE), interpolation=cv2.INTER_CUBIC), np.uint8)


def main() -> None:
    """Write docs/pictures/shapes.webp."""
    tiles = []
    for name, scene in zip(NAMES, scenes(), strict=True):
        named = np.vstack([tile(*scene), label(name, TILE, LETTERS)])
        tiles.append(np.pad(named, ((GAP, 0), (GAP, GAP), (0, 0)), constant_values=255))
    rows = [np.hstack(tiles[k : k + COLUMNS]) for k in range(0, len(tiles), COLUMNS)]
    path = Path(__file__).with_name("shapes.webp")
    cv2.imwrite(str(path), np.vstack(rows), [cv2.IMWRITE_WEBP_QUALITY, QUALITY])
    print(f"{path}: {path.stat().st_size // 1000} kB")


if __name__ == "__main__":
    main()

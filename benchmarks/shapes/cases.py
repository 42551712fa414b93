"""The shapes that are measured: what is rendered, which family follows it, and how far an answer is from the truth."""

import math
from typing import Any

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

import matchset as ms
from matchset.shapes.shape import outline
from matchset.sim.clips.shape_clip import ShapeClip

Floats = npt.NDArray[np.float64]
Corners = tuple[tuple[float, float], ...]
Errors = dict[str, float]

ASPECT = 1.5
TILT = 0.45  # rad: how far a quadrilateral turns out of the picture's plane
THIRD = 1.0 / 3.0


def regular(sides: int) -> Corners:
    """Corners of a regular polygon, the first one on top."""
    turns = [2.0 * math.pi * k / sides - 0.5 * math.pi for k in range(sides)]
    return tuple((math.cos(t), math.sin(t)) for t in turns)


def ellipse_points() -> Corners:
    """Many points of an ellipse of the aspect that is measured."""
    turns = [2.0 * math.pi * k / 360 for k in range(360)]
    return tuple((ASPECT * math.cos(t), math.sin(t)) for t in turns)


def egg_support(t: Floats) -> Floats:
    """Support function of an egg."""
    return np.asarray(10.0 + 2.0 * np.cos(t) + 0.7 * np.cos(2.0 * t))


def half_disc() -> Corners:
    """Half a disc: one side, two corners, an arc."""
    return tuple((math.cos(t), math.sin(t) - 0.42) for t in np.linspace(0.0, math.pi, 120).tolist())


def centered(family: type[Any]) -> Corners:
    """Outline of a family's shape about its center."""
    return tuple(map(tuple, outline(family.from_coarse(0.0, 0.0, 1.0), 360).tolist()))


class Case(msgspec.Struct, frozen=True):
    """A shape that is measured.

    Parameters
    ----------
    family : type
        Which family follows it.
    corners : tuple of (float, float)
        Its outline, see `ShapeClip`.
    kind : str
        What is measured: "axes" of an ellipse, "corners", or "overlap".
    tilt : float
        How far it turns out of the picture's plane, rad.
    """

    family: type[Any]
    corners: Corners
    kind: str
    tilt: float = 0.0

    def clip(self, preset: str, seed: int, frames: int, hidden: float = 0.0) -> ShapeClip:
        """Sequence of this shape."""
        return ShapeClip(
            corners=self.corners,
            tilt=self.tilt,
            preset=preset,
            seed=seed,
            frames=frames,
            hidden=hidden,
        )

    def errors(self, clip: ShapeClip, index: int, found: Any) -> Errors:
        """How far a shape, or an outline (k, 2) px, is from the truth of a frame."""
        truth = clip.outline(float(index))
        if self.kind == "axes":
            return ellipse_errors(found, clip.place(float(index)))
        points = found if isinstance(found, np.ndarray) else outline(found, 360)
        if self.kind == "corners":
            return {"corners": corner_error(points, truth)}
        return {"overlap": overlap(points, truth)}


def _cases() -> dict[str, Case]:
    triangle, egg = ms.Polygon.of([(0, 0), (4, 0), (0, 3)]), ms.Convex.of(egg_support)
    sign, hexagon = ms.Polygon.of(regular(8)), ms.Polygon.of(regular(6), motion="affine")
    half = ms.Convex.of(half_disc(), motion="affine")
    frame = ((-1.5, -1.0), (1.5, -1.0), (1.5, 1.0), (-1.5, 1.0))
    stretched = tuple((1.3 * x, y) for x, y in regular(6))
    return {
        "ellipse": Case(ms.Ellipse, ellipse_points(), "axes"),
        "rectangle": Case(ms.Rectangle, frame, "corners"),
        "square": Case(ms.Rectangle, ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)), "corners"),
        "quadrilateral": Case(ms.Quadrilateral, frame, "corners", TILT),
        "triangle": Case(triangle, centered(triangle), "overlap"),
        "stop sign": Case(sign, centered(sign), "overlap"),
        "affine hexagon": Case(hexagon, stretched, "overlap"),
        "egg": Case(egg, centered(egg), "overlap"),
        "affine half disc": Case(half, half_disc(), "overlap"),
    }


def ellipse_errors(found: Any, truth: tuple[float, float, float, float]) -> Errors:
    """Distance of the centers and mean difference of the semi-axes, px, and difference of the angles, degrees."""
    x, y, size, turn = truth
    a, b, angle = (
        (found.a, found.b, found.angle) if found.a >= found.b else (found.b, found.a, found.angle + math.pi / 2)
    )
    off = math.remainder(angle - turn, math.pi)
    true = size * math.sqrt(ASPECT), size / math.sqrt(ASPECT)
    return {
        "center": math.hypot(found.x - x, found.y - y),
        "axes": 0.5 * (abs(a - true[0]) + abs(b - true[1])),
        "angle": abs(math.degrees(off)),
    }


def corner_error(found: Floats, truth: Floats) -> float:
    """Mean distance of corners, px; whichever of them is called the first."""
    if len(found) != len(truth):
        return math.inf
    turned = [np.roll(each, k, axis=0) for each in (found, found[::-1]) for k in range(len(found))]
    return min(float(np.hypot(*(each - truth).T).mean()) for each in turned)


def overlap(one: Floats, other: Floats) -> float:
    """Area common to two convex outlines, over the area of both (IoU)."""
    a, b = one.astype(np.float32), other.astype(np.float32)
    common, _ = cv2.intersectConvexConvex(a, b)
    return float(common / (abs(cv2.contourArea(a)) + abs(cv2.contourArea(b)) - common))


CASES = _cases()

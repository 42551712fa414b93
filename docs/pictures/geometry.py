"""Draw the geometry of docs/localization.md: `python docs/pictures/geometry.py`, from the root of the repository.

The outline and the places in the picture are computed by the library, for a ball that is far too large and near.
"""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Ellipse

import matchset as ms
from matchset.app.drawing.plot_style import DASHES, INK, OURS, PAPER, QUIET, SERIES, TEXT, figure_of, write_svg
from matchset.sim.clips.truth import sphere_outline

Floats = npt.NDArray[np.float64]
Place = tuple[float, float] | Floats

BALL, MARKER = SERIES[0], SERIES[2]
X, Y, Z = OURS, SERIES[1], SERIES[0]
CAMERA = ms.CameraModel(width=640, height=480, fx=230.0, fy=230.0, cx=319.5, cy=239.5)
CENTER, RADIUS = np.array((0.8, 0.0, 1.0)), 0.33  # m; far too large and too near, to see something
SCREEN = 0.6  # m before the camera: where the picture is drawn
WIDTH = 540  # px: letters can be read on a phone


def main() -> None:
    """Write docs/pictures/geometry_cone.svg and the others."""
    for name, draw in FIGURES.items():
        path = Path(__file__).with_name(f"geometry_{name}.svg")
        write_svg(draw(), path)
        print(f"{path}: {path.stat().st_size // 1000} kB")


def cone_figure() -> Figure:
    """Show from above why the middle of the outline is not the center, and its radius not f R / distance."""
    figure, axes = drawing(520, (-0.36, 1.34), (-0.14, 1.50))
    center = CENTER[[0, 2]]
    far = float(np.linalg.norm(center))
    alpha, yaw = math.asin(RADIUS / far), math.atan2(center[0], center[1])
    disc(axes, center, RADIUS, BALL)
    line(axes, (0.0, 0.0), (0.0, 1.38), QUIET, DASHES)
    note(axes, (0.0, 1.41), "the camera's axis, z", QUIET)
    line(axes, (-0.30, SCREEN), (SCREEN * 320.0 / 230.0, SCREEN), INK, width=2.2)
    note(axes, (-0.30, SCREEN + 0.05), "the picture", INK, "left")
    line(axes, (0.0, 0.0), center, INK)
    hits = []
    for angle in (yaw - alpha, yaw + alpha):
        touch = far * math.cos(alpha) * np.array((math.sin(angle), math.cos(angle)))
        line(axes, (0.0, 0.0), 1.14 * touch, OURS)
        line(axes, center, touch, BALL, ":")
        dot(axes, touch, BALL, 4.5)
        hits.append(SCREEN * math.tan(angle))
    note(axes, 0.5 * (center + touch) + (0.045, 0.02), "R", BALL, "left")
    middle, ray = 0.5 * (hits[0] + hits[1]), SCREEN * math.tan(yaw)
    line(axes, (hits[0], SCREEN), (hits[1], SCREEN), OURS, width=4.5)
    dot(axes, (middle, SCREEN), OURS)
    dot(axes, (ray, SCREEN), INK)
    pointer(axes, (middle, SCREEN), (0.74, 0.40), "the outline's middle", OURS)
    pointer(axes, (ray, SCREEN), (0.74, 0.30), "the center", INK)
    pointer(axes, 0.28 * center, (0.74, 0.20), "its distance", INK)
    arc(axes, 0.44, (0.0, yaw), INK)
    note(axes, (0.115, 0.475), "yaw > 0", INK)
    arc(axes, 0.84, (yaw - alpha, yaw), OURS)
    note(axes, 0.90 * np.array((math.sin(yaw - alpha / 2), math.cos(yaw - alpha / 2))), "α", OURS)
    note(axes, (0.74, 0.06), "sin α = R / distance", INK, "left")
    camera(axes)
    return figure


def picture_figure() -> Figure:
    """Show what the camera sees: an ellipse, longer away from the middle of the picture."""
    figure, axes = drawing(420, (-6.0, 646.0), (486.0, -6.0))
    place = np.add(CENTER, (0.0, 0.30, 0.0))
    outline = sphere_outline(CAMERA, place, RADIUS)
    points, many = outline.points(40), outline.points(360)
    axes.plot((0, 640, 640, 0, 0), (0, 0, 480, 480, 0), color=INK, linewidth=2.2)
    axes.plot(CAMERA.cx, CAMERA.cy, "+", color=QUIET, markersize=12, markeredgewidth=1.5)
    note(axes, (CAMERA.cx, CAMERA.cy - 24), "principal point", QUIET)
    axes.fill(many[:, 0], many[:, 1], facecolor=BALL, alpha=0.14, linewidth=0)
    axes.plot(many[:, 0], many[:, 1], color=BALL, linewidth=1.3)
    circle = outline.circle()
    axes.add_patch(Circle((circle.x, circle.y), circle.radius, fill=False, edgecolor=INK, linestyle=DASHES))
    axes.plot(points[:, 0], points[:, 1], "o", color=OURS, markersize=4.0)
    below = circle.y + circle.radius
    pointer(axes, (circle.x - 0.5 * circle.radius, below - 0.134 * circle.radius), (330, 442), "the best circle", INK)
    left = points[np.argmin(points[:, 0])]
    pointer(axes, (left[0], left[1]), (330, 380), "the match-set", OURS)
    seen = CAMERA.project(place[np.newaxis])[0]
    dot(axes, seen, INK, 6.5)
    note(axes, np.add(seen, (12.0, 0.0)), "the center", INK, "left")
    direction = np.array((-0.75, -0.35, -0.63)) / np.linalg.norm((-0.75, -0.35, -0.63))
    spot = CAMERA.project((place + RADIUS * direction)[np.newaxis])[0]
    axes.add_patch(Ellipse((spot[0], spot[1]), 22, 27, facecolor=MARKER, edgecolor="none"))
    note(axes, np.add(spot, (18.0, -8.0)), "marker", INK, "left")
    for tip, name, color, at in (((100, 28), "x", X, (112, 28)), ((28, 100), "y", Y, (28, 118))):
        arrow(axes, (28, 28), tip, color)
        note(axes, at, name, color)
    return figure


def frames_figure() -> Figure:
    """Show both frames from above, the marker's ray and the camera as the ball sees it."""
    figure, axes = drawing(520, (-0.74, 0.94), (-0.14, 1.48))
    center, radius = np.array((0.35, 1.02)), 0.24
    disc(axes, center, radius, BALL)
    out = np.array((-math.sin(0.95), -math.cos(0.95)))  # the ball's z: out through marker 0
    right = np.array((out[1], -out[0]))  # its x = y cross z, y pointing down, away from the eye
    spot = center + radius * out
    heading, side = float(-center @ out), float(-center @ right)
    foot = center + heading * out
    line(axes, center, foot, Z, DASHES)
    line(axes, foot, (0.0, 0.0), X, DASHES)
    note(axes, 0.5 * (spot + foot) + (-0.12, 0.07), "heading", Z, "right")
    note(axes, 0.5 * foot + (-0.05, -0.04), f"side {'>' if side > 0 else '<'} 0", X, "right")
    line(axes, (0.0, 0.0), spot, MARKER)
    note(axes, 0.50 * spot + (-0.04, 0.0), "marker's ray", INK, "right")
    line(axes, (0.0, 0.0), center, INK, ":")
    note(axes, 0.52 * center + (0.04, 0.0), "position", INK, "left")
    for tip, color in ((out, Z), (right, X)):
        arrow(axes, center, center + 0.44 * tip, color)
    note(axes, center + 0.44 * out + (-0.01, 0.07), "z", Z)
    note(axes, center + 0.50 * right, "x", X)
    dot(axes, spot, MARKER, 10.0)
    axes.plot(*center, "x", color=Y, markersize=9, markeredgewidth=2.2, zorder=7)
    pointer(axes, center, (0.64, 1.12), "y, down:\ninto the page", Y)
    note(axes, np.add(center, (0.02, 0.34)), "the ball and its frame", INK, "left")
    for tip, color, name in (((0.0, 0.32), Z, "z"), ((0.32, 0.0), X, "x")):
        arrow(axes, (0.0, 0.0), tip, color)
        note(axes, np.multiply(tip, 1.13), name, color)
    camera(axes)
    note(axes, (0.09, -0.10), "and its frame", INK, "left")
    return figure


FIGURES: dict[str, Callable[[], Figure]] = {"cone": cone_figure, "picture": picture_figure, "frames": frames_figure}


def drawing(height: int, x: tuple[float, float], y: tuple[float, float]) -> tuple[Figure, Axes]:
    """Begin a drawing without axes, in which a unit is as long in x as in y."""
    figure, (axes,) = figure_of((WIDTH, height))
    axes.set_aspect("equal")
    axes.axis("off")
    axes.set_xlim(*x)
    axes.set_ylim(*y)
    return figure, axes


def camera(axes: Axes) -> None:
    """Put the camera at the origin."""
    axes.plot(0.0, 0.0, "^", color=INK, markersize=12, zorder=6)
    note(axes, (0.0, -0.10), "camera", INK)


def disc(axes: Axes, at: Place, radius: float, color: str) -> None:
    """Draw a filled circle."""
    axes.add_patch(Circle((at[0], at[1]), radius, facecolor=color, edgecolor="none", alpha=0.14))
    axes.add_patch(Circle((at[0], at[1]), radius, fill=False, edgecolor=color, linewidth=1.5))


def dot(axes: Axes, at: Place, color: str, size: float = 8.0) -> None:
    """Draw a point."""
    axes.plot(at[0], at[1], "o", color=color, markersize=size, markeredgecolor=PAPER, zorder=6)


def line(axes: Axes, begin: Place, end: Place, color: str, style: Any = "-", width: float = 1.5) -> None:
    """Draw a straight line."""
    axes.plot((begin[0], end[0]), (begin[1], end[1]), linestyle=style, color=color, linewidth=width)


def arc(axes: Axes, radius: float, angles: tuple[float, float], color: str) -> None:
    """Draw a part of a circle around the camera, between two angles from its axis, rad."""
    low, high = (90.0 - math.degrees(angle) for angle in angles)
    axes.add_patch(Arc((0.0, 0.0), 2.0 * radius, 2.0 * radius, theta1=high, theta2=low, color=color, linewidth=1.5))


def arrow(axes: Axes, begin: Place, end: Place, color: str) -> None:
    """Draw an arrow."""
    style = {"arrowstyle": "-|>", "color": color, "linewidth": 2.0, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", (float(end[0]), float(end[1])), (float(begin[0]), float(begin[1])), arrowprops=style)


def note(axes: Axes, at: Place, words: str, color: str, side: str = "center") -> None:
    """Write beside or at a point."""
    axes.text(at[0], at[1], words, color=color, fontsize=TEXT, ha=side, va="center")  # type: ignore[arg-type]


def pointer(axes: Axes, at: Place, words_at: tuple[float, float], words: str, color: str) -> None:
    """Write words, and a thin line from them to what they are about."""
    style = {"arrowstyle": "-", "color": color, "linewidth": 1.0, "shrinkA": 2.0, "shrinkB": 4.0}
    axes.annotate(
        words,
        (float(at[0]), float(at[1])),
        words_at,
        color=color,
        fontsize=TEXT,
        va="center",
        arrowprops=style,
    )


if __name__ == "__main__":
    main()

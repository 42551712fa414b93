"""Draw the geometry of docs/localization.md: `python docs/pictures/geometry.py`, from the root of the repository.

The outline and the places in the picture are computed by the library, for a ball that is far too large and near.
"""

import math
from pathlib import Path

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle, Ellipse

import matchset as ms
from matchset.sim.clips.truth import sphere_outline

Floats = npt.NDArray[np.float64]

PINK, INK, PALE, BLUE, PURPLE = "#ff28be", "#444444", "#bbbbbb", "#2f6fde", "#8a2be2"
RED, GREEN = "#d62728", "#2a9d3a"
CAMERA = ms.CameraModel(width=640, height=480, fx=330.0, fy=330.0, cx=319.5, cy=239.5)
BALL, RADIUS = np.array((0.62, 0.0, 1.0)), 0.25  # m; far too large and too near, to see something
SCREEN = 0.42  # m before the camera: where the picture is drawn


def main() -> None:
    """Write docs/pictures/geometry.png."""
    figure = Figure(figsize=(15.0, 5.6), dpi=100)
    axes = figure.subplots(1, 3, width_ratios=(1.15, 1.0, 1.0))
    figure.subplots_adjust(left=0.01, right=0.99, top=0.92, bottom=0.02, wspace=0.04)
    draw_cone(axes[0])
    draw_picture(axes[1])
    draw_frames(axes[2])
    for each in axes:
        each.set_aspect("equal")
        each.axis("off")
        each.set_anchor("N")
    path = Path(__file__).with_name("geometry.png")
    FigureCanvasAgg(figure).print_png(str(path))  # type: ignore[no-untyped-call]
    print(f"{path}: {path.stat().st_size // 1000} kB")


def draw_cone(axes: Axes) -> None:
    """Show from above why the middle of the outline is not the center, and its radius not f R / distance."""
    axes.set_title("1. the tangent cone, from above", loc="left", color=INK)
    center = BALL[[0, 2]]
    far = float(np.linalg.norm(center))
    alpha, yaw = math.asin(RADIUS / far), math.atan2(center[0], center[1])
    axes.add_patch(Circle((center[0], center[1]), RADIUS, facecolor="#dfe9fb", edgecolor=BLUE))
    line(axes, (0.0, 0.0), (0.0, 1.3), PALE, "--")
    note(axes, (0.0, 1.3), "camera's axis, z", (5, -3), PALE)
    line(axes, (0.0, 0.0), center, INK)
    line(axes, (-0.10, SCREEN), (0.72, SCREEN), INK, width=2.0)
    note(axes, (-0.10, SCREEN), "picture", (-2, 6))
    hits = []
    for angle in (yaw - alpha, yaw + alpha):
        touch = far * math.cos(alpha) * np.array((math.sin(angle), math.cos(angle)))
        line(axes, (0.0, 0.0), 1.12 * touch, PINK)
        line(axes, center, touch, BLUE, ":")
        axes.plot(*touch, "o", color=BLUE, markersize=4)
        hits.append(SCREEN * math.tan(angle))
    middle, axis = 0.5 * (hits[0] + hits[1]), SCREEN * math.tan(yaw)
    line(axes, (hits[0], SCREEN), (hits[1], SCREEN), PINK, width=4.0)
    axes.plot(middle, SCREEN, "o", color=PINK, markersize=7, markeredgecolor="white", zorder=5)
    axes.plot(axis, SCREEN, "o", color=INK, markersize=7, markeredgecolor="white", zorder=6)
    note(axes, (middle, SCREEN), "middle of the outline", (8, -14), PINK)
    note(axes, (axis, SCREEN), "the center's ray", (-26, 12), INK)
    axes.add_patch(Arc((0.0, 0.0), 0.5, 0.5, theta1=90 - math.degrees(yaw), theta2=90, color=INK))
    note(axes, (0.05, 0.265), "yaw > 0", (-4, 0))
    axes.add_patch(
        Arc((0, 0), 1.5, 1.5, theta1=90 - math.degrees(yaw), theta2=90 - math.degrees(yaw - alpha), color=PINK)
    )
    note(axes, (0.75 * math.sin(yaw - alpha / 2), 0.75 * math.cos(yaw - alpha / 2)), "α", (-5, 3), PINK)
    note(axes, 0.5 * (center + touch), "R", (4, 2), BLUE)
    note(axes, (0.66, 1.33), "sin α = R / distance", (-20, 0), INK)
    draw_camera(axes)
    axes.set_xlim(-0.24, 1.05)
    axes.set_ylim(-0.12, 1.42)


def draw_picture(axes: Axes) -> None:
    """Show what the camera sees: an ellipse, longer away from the middle of the picture."""
    axes.set_title("2. the picture: an ellipse, its match-set, the marker", loc="left", color=INK)
    place = np.add(BALL, (0.0, 0.28, 0.0))
    outline = sphere_outline(CAMERA, place, RADIUS)
    points = outline.points(40)
    axes.plot((0, 640, 640, 0, 0), (0, 0, 480, 480, 0), color=INK, linewidth=2.0)
    axes.plot(CAMERA.cx, CAMERA.cy, "+", color=PALE, markersize=12)
    note(axes, (CAMERA.cx, CAMERA.cy), "principal point", (-40, 10), PALE)
    many = outline.points(360)
    axes.fill(many[:, 0], many[:, 1], facecolor="#dfe9fb", edgecolor=BLUE)
    axes.plot(points[:, 0], points[:, 1], "o", color=PINK, markersize=3.5)
    circle = outline.circle()
    axes.add_patch(Circle((circle.x, circle.y), circle.radius, fill=False, edgecolor=INK, linestyle=(0, (4, 3))))
    note(axes, (circle.x - circle.radius, circle.y), "best circle", (-84, 0), INK)
    note(axes, (float(points[:, 0].min()), float(points[:, 1].max())), "match-set", (-42, -4), PINK)
    seen = CAMERA.project(place[np.newaxis])[0]
    axes.plot(*seen, "o", color=INK, markersize=6)
    note(axes, (seen[0], seen[1]), "center", (6, -12), INK)
    direction = np.array((-0.75, -0.2, -0.63)) / np.linalg.norm((-0.75, -0.2, -0.63))
    spot = CAMERA.project((place + RADIUS * direction)[np.newaxis])[0]
    axes.add_patch(Ellipse((spot[0], spot[1]), 24, 30, facecolor=PURPLE, edgecolor="none"))
    note(axes, (spot[0], spot[1]), "marker", (-10, 14), PURPLE)
    arrow(axes, (30, 30), (110, 30), RED)
    note(axes, (110, 30), "x", (4, -3), RED)
    arrow(axes, (30, 30), (30, 110), GREEN)
    note(axes, (30, 110), "y", (-3, -14), GREEN)
    axes.set_xlim(-10, 650)
    axes.set_ylim(560, -80)


def draw_frames(axes: Axes) -> None:
    """Show both frames from above, the marker's ray and the camera as the ball sees it."""
    axes.set_title("3. the marker's ray, frames and signs, from above", loc="left", color=INK)
    center, radius = np.array((0.35, 1.05)), 0.22
    axes.add_patch(Circle((center[0], center[1]), radius, facecolor="#dfe9fb", edgecolor=BLUE))
    out = np.array((-math.sin(0.95), -math.cos(0.95)))  # the ball's z: out through marker 0
    right = np.array((out[1], -out[0]))  # its x = y cross z, y pointing down, away from the eye
    spot = center + radius * out
    line(axes, (0.0, 0.0), spot, PURPLE)
    axes.plot(*spot, "o", color=PURPLE, markersize=9)
    note(axes, (0.55 * spot[0], 0.55 * spot[1]), "marker's ray", (-72, 0), PURPLE)
    for tip, color, name in ((out, BLUE, "z"), (right, RED, "x")):
        arrow(axes, center, center + 0.42 * tip, color)
        note(axes, center + 0.42 * tip, name, (-2, 8) if name == "x" else (-2, -16), color)
    note(axes, center, "y down\n(into the page)", (7, -32), GREEN)
    axes.plot(*center, "x", color=GREEN, markersize=7)
    heading, side = float(-center @ out), float(-center @ right)
    foot = center + heading * out
    line(axes, center, foot, BLUE, "--")
    line(axes, foot, (0.0, 0.0), RED, "--")
    note(axes, 0.3 * center + 0.7 * foot, "heading", (-54, 4), BLUE)
    note(axes, 0.5 * foot, f"side {'> 0' if side > 0 else '< 0'}", (-48, -8), RED)
    arrow(axes, (0.0, 0.0), (0.0, 0.34), BLUE)
    arrow(axes, (0.0, 0.0), (0.34, 0.0), RED)
    note(axes, (0.0, 0.34), "z", (4, 0), BLUE)
    note(axes, (0.34, 0.0), "x", (3, -4), RED)
    line(axes, (0.0, 0.0), center, INK, ":")
    note(axes, 0.62 * center, "position", (6, -8), INK)
    draw_camera(axes)
    axes.set_xlim(-0.72, 0.82)
    axes.set_ylim(-0.16, 1.50)


def draw_camera(axes: Axes) -> None:
    """Put the camera at the origin."""
    axes.plot(0.0, 0.0, "^", color=INK, markersize=12)
    note(axes, (0.0, 0.0), "camera", (-18, -20))


def line(
    axes: Axes,
    begin: tuple[float, float] | Floats,
    end: tuple[float, float] | Floats,
    color: str,
    style: str = "-",
    width: float = 1.3,
) -> None:
    """Draw a straight line."""
    axes.plot((begin[0], end[0]), (begin[1], end[1]), style, color=color, linewidth=width)


def arrow(axes: Axes, begin: tuple[float, float] | Floats, end: tuple[float, float] | Floats, color: str) -> None:
    """Draw an arrow."""
    style = {"arrowstyle": "-|>", "color": color, "linewidth": 1.8, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", (float(end[0]), float(end[1])), (float(begin[0]), float(begin[1])), arrowprops=style)


def note(
    axes: Axes, place: tuple[float, float] | Floats, words: str, shift: tuple[float, float], color: str = INK
) -> None:
    """Write beside a point."""
    spot = float(place[0]), float(place[1])
    axes.annotate(words, spot, xytext=shift, textcoords="offset points", color=color, fontsize=11)


if __name__ == "__main__":
    main()

"""The plots of a flight's report, as PNG; only reports import this file, which loads Matplotlib."""

import io
from collections.abc import Callable

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from matchset.app.drawing.curves import INK, PALE, PINK, style_axes
from matchset.app.flight.log import FlightLog, FollowerLog
from matchset.app.flight.score import SCORING
from matchset.app.flight_report.colors import as_hex, vehicle_rgb
from matchset.localization.chain import FACING_AWAY, seen_from_last
from matchset.localization.pose import Pose

Floats = npt.NDArray[np.float64]

BARS = 40  # format: of a histogram
NAMES = ("side, m", "height, m", "heading, m")
# geometry: px; larger errors are counted in the histogram's last bar
LAST_BAR_PX = 10.0


def paths_png(log: FlightLog) -> bytes:
    """Draw the paths from above: in the room, and in the frame of the last ball as estimated and by the truth."""
    figure = Figure(figsize=(14.8, 5.6), dpi=100)
    left, right = figure.subplots(1, 2)
    for number in range(log.setup.followers + 1):
        path = log.balls_in_room[:, number]
        left.plot(path[:, 2], path[:, 0], color=_color(number), linewidth=1.2, label=f"vehicle {number + 1}")
    left.set_title("in the room (truth)", loc="left", color=INK, fontsize=11)
    left.legend(frameon=False, fontsize=9, labelcolor=INK)
    for number, follower in enumerate(log.followers):
        _draw_path(right, number, follower)
    right.plot(0.0, 0.0, "o", color=_color(log.setup.followers), markersize=14)
    goals = np.array(
        [place.position for place in seen_from_last([_pose_at_set_place(log)] * len(log.followers)) if place]
    )
    right.plot(goals[:, 2], goals[:, 0], "+", color=INK, markersize=14, markeredgewidth=1.6)
    title = "in the level frame of the last ball: dots as the chain sees it, line the truth, + set places"
    right.set_title(title, loc="left", color=INK, fontsize=11)
    for axes, across in ((left, "x, m (right)"), (right, "side of the last ball, m")):
        axes.set_ylabel(across)
        axes.set_aspect("equal", adjustable="datalim")
        axes.invert_yaxis()
    left.set_xlabel("z, m (forward)")
    right.set_xlabel("before the last ball's marker, m")
    right.invert_xaxis()
    right.invert_yaxis()
    return _png(figure, grid="both")


def coordinates_png(log: FlightLog, number: int) -> bytes:
    """Draw side, height and heading of a follower, from 0, over time: truth, estimate, and set place."""
    figure = Figure(figsize=(14.8, 5.6), dpi=100)
    rows = figure.subplots(3, 1, sharex=True)
    follower, place = log.followers[number], log.setup.parameters.pilot.place
    delay = log.setup.parameters.pilot.follower.ego_motion.delay
    for axis, axes in enumerate(rows):
        wanted = (place.side, place.height, place.heading)[axis]
        axes.axhline(wanted, color=INK, linewidth=0.8, linestyle=(0, (4, 4)), label="set place")
        axes.plot(follower.time, follower.true_position[:, axis], color=INK, linewidth=1.0, label="truth")
        estimated = follower.estimated_position[:, axis]
        axes.plot(follower.time + delay, estimated, color=_color(number), linewidth=0.9, label="acted on")
        _mark_losses(axes, follower)
        axes.set_ylabel(NAMES[axis])
    rows[0].legend(frameon=False, fontsize=9, labelcolor=INK, ncols=3, loc="lower right", bbox_to_anchor=(1.0, 0.98))
    title = f"{number + 1} beside {number + 2}; ticks below: the ball was not found"
    rows[0].set_title(title, loc="left", color=INK, fontsize=11)
    rows[-1].set_xlabel("time, s")
    return _png(figure)


def errors_png(log: FlightLog) -> bytes:
    """Draw the histograms: error of the circles as in the paper's Fig. 6c, and distance from the set place."""
    figure = Figure(figsize=(14.8, 4.2), dpi=100)
    left, right = figure.subplots(1, 2)
    edges = np.linspace(0.0, LAST_BAR_PX, BARS + 1)
    _histogram(left, log, lambda k: np.minimum(log.followers[k].circle_error_px, LAST_BAR_PX - 1e-9), edges)
    left.set_title("error of the ball's circle, |dx| + |dy| + |dr|", loc="left", color=INK, fontsize=11)
    left.set_xlabel(f"px ({LAST_BAR_PX:g} and more in the last bar)")
    distances = [100.0 * np.linalg.norm(log.position_error(k), axis=1) for k in range(len(log.followers))]
    most = max((float(each.max()) for each in distances if each.size), default=1.0)
    _histogram(right, log, lambda k: distances[k], np.linspace(0.0, most, BARS + 1))
    title = f"true distance from the set place, from {SCORING.transient:g} s after its start on"
    right.set_title(title, loc="left", color=INK, fontsize=11)
    right.set_xlabel("cm")
    for axes in (left, right):
        axes.set_ylabel("share of the frames, %")
        axes.legend(frameon=False, fontsize=9, labelcolor=INK)
    return _png(figure)


def times_png(log: FlightLog) -> bytes:
    """Draw the age of the pictures that were acted on, with the losses, and the histogram of the computing time."""
    figure = Figure(figsize=(14.8, 3.6), dpi=100)
    left, right = figure.subplots(1, 2)
    for number, follower in enumerate(log.followers):
        left.plot(follower.time, 1000.0 * follower.age, color=_color(number), linewidth=1.0, label=_label(number))
        _mark_losses(left, follower, height=0.02 + 0.05 * number, color=_color(number))
    oldest = max(float(follower.age[np.isfinite(follower.age)].max(initial=0.0)) for follower in log.followers)
    left.set_ylim(0.0, 1.3e3 * max(oldest, 1e-3))
    left.set_title("age of the picture when its command was sent; ticks: losses", loc="left", color=INK, fontsize=11)
    left.set_xlabel("time, s")
    left.set_ylabel("age, ms")
    spent = [1e6 * follower.processing for follower in log.followers]
    most = max((float(np.nanpercentile(each, 98)) for each in spent if np.isfinite(each).any()), default=1.0)
    _histogram(right, log, lambda k: np.minimum(spent[k], most), np.linspace(0.0, most, BARS + 1))
    title = "computing from picture to command (longest 2 % in the last bar)"
    right.set_title(title, loc="left", color=INK, fontsize=11)
    right.set_xlabel("µs")
    right.set_ylabel("share of the frames, %")
    for axes in (left, right):
        axes.legend(frameon=False, fontsize=9, labelcolor=INK)
    return _png(figure)


def _pose_at_set_place(log: FlightLog) -> Pose:
    """Pose that a follower measures at its set place, looking straight ahead."""
    place = log.setup.parameters.pilot.place
    position = np.array((place.side, place.height, place.heading))
    return Pose(position=position, rotation_matrix=FACING_AWAY, covariance=np.zeros((6, 6)), observed="level", time=0.0)


def _draw_path(axes: Axes, number: int, follower: FollowerLog) -> None:
    estimated, true = follower.estimated_in_chain, follower.true_in_chain
    axes.plot(
        estimated[:, 2], estimated[:, 0], ".", color=_color(number), markersize=3, alpha=0.5, label=_label(number)
    )
    axes.plot(true[:, 2], true[:, 0], color=INK, linewidth=0.7)


def _histogram(axes: Axes, log: FlightLog, values: Callable[[int], Floats], edges: Floats) -> None:
    for number in range(len(log.followers)):
        some = values(number)
        some = some[np.isfinite(some)]
        share = np.full(len(some), 100.0 / max(len(some), 1))
        label = f"{_label(number)}: median {_brief(float(np.median(some)))}" if len(some) else _label(number)
        color = _color(number)
        axes.hist(some, edges.tolist(), weights=share, histtype="stepfilled", color=color, alpha=0.25)
        axes.hist(some, edges.tolist(), weights=share, histtype="step", color=color, linewidth=1.2, label=label)


def _mark_losses(axes: Axes, follower: FollowerLog, height: float = 0.02, color: str = PINK) -> None:
    lost = follower.time[~follower.found]
    across = axes.get_xaxis_transform()
    axes.plot(lost, np.full(len(lost), height), "|", color=color, markersize=6, transform=across, clip_on=False)


def _brief(value: float) -> str:
    return f"{value:.0f}" if abs(value) >= 100.0 else f"{value:.3g}"


def _label(number: int) -> str:
    return f"{number + 1} watches {number + 2}"


def _color(number: int) -> str:
    return as_hex(vehicle_rgb(number))


def _png(figure: Figure, grid: str = "y") -> bytes:
    """Finish a figure and return it as PNG."""
    for axes in figure.axes:
        style_axes(axes)
        if grid == "both":
            axes.grid(color="#eeeeee")
            axes.margins(0.07)
        axes.spines[["left", "bottom"]].set_color(PALE)
    wide, high = figure.get_size_inches()
    figure.subplots_adjust(0.75 / wide, 0.6 / high, 1.0 - 0.2 / wide, 1.0 - 0.4 / high, wspace=0.13, hspace=0.13)
    FigureCanvasAgg(figure)
    png = io.BytesIO()
    figure.savefig(png, format="png")
    return png.getvalue()

"""The families that the laws are asked of, each with a shape of its own, and a fit of points without any picture."""

import functools
import importlib
import math
import re
import sys
import tempfile
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import numpy.typing as npt

import matchset as ms
from kernels import robust_fit_of, workspace
from matchset.numeric.jit import compile_user_function
from matchset.shapes.shape import from_hull, outline, places

Floats = npt.NDArray[np.float64]
PAGE = Path(__file__).resolve().parents[2] / "docs" / "add_a_shape.md"

Triangle = ms.Polygon.of([(0, 0), (4, 0), (0, 3)])
StopSign = ms.Polygon.of([(math.cos(math.pi * (k + 0.5) / 4), math.sin(math.pi * (k + 0.5) / 4)) for k in range(8)])
Hexagon = ms.Polygon.of([(math.cos(math.pi * k / 3), math.sin(math.pi * k / 3)) for k in range(6)], motion="affine")
Egg = ms.Convex.of(lambda t: 10.0 + 2.0 * np.cos(t) + 0.7 * np.cos(2.0 * t))


def half_disc() -> npt.NDArray[np.bool_]:
    rows, columns = np.indices((240, 300))
    return np.asarray((np.hypot(columns - 150.3, rows - 60.7) < 130.2) & (rows > 60))


HalfDisc = ms.Convex.of(half_disc(), motion="affine")


@functools.cache
def page_example() -> Any:
    """The example of docs/add_a_shape.md as a module, run."""
    (code,) = re.findall(r"```python\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)
    folder = Path(tempfile.gettempdir()) / "matchset-add-a-shape"  # one place: compiled code is found again by it
    folder.mkdir(exist_ok=True)
    file = folder / "pick_of_the_page.py"
    if not file.exists() or file.read_text(encoding="utf-8") != code:  # a file that is written anew is compiled anew
        file.write_text(code, encoding="utf-8")
    sys.path.insert(0, str(folder))
    try:
        return importlib.import_module("pick_of_the_page")
    finally:
        sys.path.remove(str(folder))


SHAPES: dict[str, Any] = {
    "circle": ms.Circle(301.3, 208.8, 57.7),
    "ellipse": ms.Ellipse(301.3, 208.8, 73.1, 45.2, 0.6),
    "round ellipse": ms.Ellipse(301.3, 208.8, 50.0, 50.0, 0.3),
    "rectangle": ms.Rectangle(301.3, 208.8, 130.4, 81.2, 0.6),
    "square": ms.Rectangle(301.3, 208.8, 90.4, 90.4, -0.2),
    "flat rectangle": ms.Rectangle(301.3, 208.8, 190.4, 21.2, -0.9),
    "quadrilateral": ms.Quadrilateral([(240.0, 160.5), (372.2, 150.1), (350.3, 262.9), (251.0, 240.4)]),
    "triangle": Triangle(301.3, 208.8, 31.4, 0.6),
    "stop sign": StopSign(301.3, 208.8, 61.4, 0.1),
    "affine hexagon": Hexagon(301.3, 208.8, 60.0, 13.0, -8.0, 45.0),
    "egg": Egg(301.3, 208.8, 6.0, 2.0),
    "affine half disc": HalfDisc(301.3, 208.8, 0.5, 0.1, -0.2, 0.6),
}


class Fit(msgspec.Struct, frozen=True):
    """A shape that was fitted to points, and how well."""

    shape: Any
    state: Floats
    covariance: Floats
    residual: Floats


class Points(msgspec.Struct, frozen=True):
    """The outline that is to be fitted, (k, 2) in order, and which share of the lines sees none of it."""

    corners: Floats
    hidden: float = 0.0
    noise: float = 0.0


def dense(shape: Any) -> Floats:
    """The outline of a shape in many points."""
    return outline(shape, 2000)


def offsets(rows: Floats, corners: Floats) -> Floats:
    """How far along its normal each traced place meets a closed polygon; the nearest meeting."""
    a, b = corners[np.newaxis], np.roll(corners, -1, axis=0)[np.newaxis]
    p, n = rows[:, np.newaxis, :2], rows[:, np.newaxis, 2:4]
    side, from_a = b - a, a - p
    across = n[..., 0] * side[..., 1] - n[..., 1] * side[..., 0]
    with np.errstate(divide="ignore", invalid="ignore"):
        along = (from_a[..., 0] * side[..., 1] - from_a[..., 1] * side[..., 0]) / across
        share = (from_a[..., 0] * n[..., 1] - from_a[..., 1] * n[..., 0]) / across
    along = np.where((share >= -1e-9) & (share <= 1.0 + 1e-9) & np.isfinite(along), along, np.inf)
    best = np.abs(along).argmin(axis=1)
    return np.asarray(along[np.arange(len(rows)), best])


def fit(family: type[Any], points: Points, start: Any, lines: int = 64, spread: float = 0.0) -> Fit:
    """Fit points by the tracker's own kernel, tracing anew until nothing moves."""
    state, begin = start.state.copy(), start.state.copy()
    s, p = len(state), len(family.parameters)
    where, trace = places(family, lines), compile_user_function(family.trace)
    errors = np.random.default_rng(5).normal(0.0, max(points.noise, 1e-12), lines)
    work = workspace(lines, s, p)
    work.window.use_prior, work.fit_limits.min_noise, work.motion.prior_sigma[:p] = 1, 0.05, spread
    work.start[:s] = begin
    work["field_offset"] = (0.0, 0.0), (0.0, 0.0), 1.0
    for _ in range(25):
        rows, edges = np.zeros((lines, 4 + s + 2)), np.zeros((lines, 3, 3))
        trace(state, where, rows)
        meets = offsets(rows, points.corners)
        seen = np.isfinite(meets) & (np.arange(lines) >= points.hidden * lines)
        edges[seen, 0, 0], edges[seen, 0, 1:] = (meets + errors)[seen], 1.0
        work.outline[:lines, : 4 + s + 2], work.edges[:lines], work.state[:s] = rows, edges, state
        work["iteration"] = float(family.half_width(state)), 0.4, 8.0, 0.0, 1.0
        robust_fit_of(work)
        assert work.iteration.noise > 0.0, "no fit"
        state[:] = work.state[:s]
        if work.iteration.moved < 1e-7:
            break
    rows = np.zeros((lines, 4 + s + 2))
    trace(state, where, rows)
    return Fit(family.from_state(state, start), state, work.covariance[:p, :p].copy(), offsets(rows, points.corners))


def begin_at(family: type[Any], corners: Floats) -> Any:
    """A shape to begin at, from the outline itself."""
    return next(iter(from_hull(family, corners)))


def apart(one: Any, other: Floats) -> float:
    """Largest distance of a shape's outline from another outline, px, along its normals."""
    state = one.state
    rows = np.zeros((97, 4 + len(state)))
    compile_user_function(type(one).trace)(state, places(type(one), 97), rows)
    return float(np.abs(offsets(rows, other)).max())

"""The rules of the contract, asked of a family before it is followed: `check_family`."""

import functools
from collections.abc import Hashable
from typing import Any, cast

import numpy as np
import numpy.typing as npt

from matchset.numeric.jit import compile_user_function, interpreted
from matchset.shapes.shape import places, slopes

Floats = npt.NDArray[np.float64]

LINES = 24  # geometry: places at which the outline is looked at
X, Y, SIZE = 107.0, 83.0, 30.0  # geometry: the shape that is asked for
STEP = 1e-4  # geometry: px, by how much a state is moved to see what the outline does
OWN = "matchset.shapes."
NEEDED = ("parameters", "trace", "half_width", "state", "from_state", "from_coarse")


def check_family(family: type[Any]) -> None:
    """Refuse a user's family that breaks the contract of `Shape`; the package's own are checked by its tests.

    Parameters
    ----------
    family : type

    Raises
    ------
    ValueError
        If it breaks a rule; the message says which.
    """
    if not isinstance(cast(object, family), type):
        raise ValueError(f"{family!r:.60} is no family of shapes: it is no class")
    if not family.__module__.startswith(OWN):
        check_contract(family)


def check_contract(family: type[Any]) -> None:
    """Refuse a family, of the package or not, that breaks the contract of `Shape`; see `check_family`."""
    _check(cast(Hashable, family))


@functools.lru_cache(maxsize=256)
def _check(family: Any) -> None:
    name = getattr(family, "__name__", repr(family))
    missing = [each for each in NEEDED if not hasattr(family, each)]
    if missing:
        raise ValueError(f"{name} is no family of shapes: it has no {', '.join(missing)}")
    try:
        with np.errstate(all="ignore"):
            broken = _broken_rule(family)
    except Exception as error:  # whatever a user's code may raise
        raise ValueError(f"{name} is no family of shapes: {type(error).__name__}: {error}") from error
    if broken:
        raise ValueError(f"{name} is no family of shapes: {broken}")


def _broken_rule(family: type[Any]) -> str:
    """Say which rule is broken, if any."""
    names = family.parameters
    if not (isinstance(names, tuple) and len(names) >= 3 and all(isinstance(name, str) for name in names)):
        return f"parameters must be a tuple of at least three names, got {names!r}"
    where = places(family, LINES)
    if where.ndim != 2 or len(where) != LINES or where.shape[1] < 2 or not np.isfinite(where).all():
        return f"places({LINES}) must be finite numbers of shape ({LINES}, >= 2), got shape {where.shape}"
    first = family.from_coarse(X, Y, SIZE)
    if not isinstance(first, family):
        return f"from_coarse must return a {family.__name__}, got {first!r}"
    state = first.state
    if not (isinstance(state, np.ndarray) and state.ndim == 1 and state.dtype == np.float64):
        return f"state must be a float64 array of shape (s,), got {state!r}"
    if len(state) < len(names) or not np.isfinite(state).all():
        return f"state must hold at least as many finite numbers as there are parameters, {len(names)}, got {state}"
    uneven = state.copy()
    uneven[2 : len(names)] *= 1.0 + 0.1 * np.cos(1.3 * np.arange(len(names) - 2))
    for each in (state, uneven):
        broken = _broken_size(family, each) or _broken_outline(family, where, each) or _broken_answer(family, each)
        if broken:
            return broken
    return _broken_compiler(family, where, state)


def _broken_size(family: type[Any], state: Floats) -> str:
    """Rules of `half_width` and `from_coarse`."""
    size = float(interpreted(family.half_width)(state))
    if not 0.5 * SIZE < size < 2.0 * SIZE:
        return f"half_width of from_coarse(x, y, {SIZE:g}) must be about {SIZE:g} px, got {size:g}"
    again = family.from_coarse(X + 9.0, Y, 2.0 * size, state).state
    grown = float(interpreted(family.half_width)(again))
    if abs(again[0] - X - 9.0) > 0.05 * SIZE or abs(again[1] - Y) > 0.05 * SIZE or abs(grown - 2.0 * size) > 0.1 * size:
        return (
            f"from_coarse(x, y, radius, like) must have its center and half-width there: asked for {X + 9.0:g}, {Y:g}, "
            f"{2.0 * size:g}, got {again[0]:g}, {again[1]:g}, {grown:g}"
        )
    return ""


def _traced(family: type[Any], where: Floats, state: Floats) -> Floats:
    """Outline in interpreted Python, which notices what goes beyond an array."""
    outline = np.full((len(where), 4 + len(state) + 2), np.nan)
    interpreted(family.trace)(state, where, outline)
    return outline


def _broken_outline(family: type[Any], where: Floats, state: Floats) -> str:
    """Rules of `trace`."""
    before, rows = state.copy(), _traced(family, where, state)
    if not np.array_equal(before, state):
        return "trace must not change the state"
    outline, beyond = rows[:, :-2], rows[:, -2:]
    if not np.isfinite(outline).all():
        wrong = np.argwhere(~np.isfinite(outline))[0].tolist()
        return f"trace must write 4 + {len(state)} finite numbers a place, got {outline[wrong[0], wrong[1]]} at {wrong}"
    if not np.isnan(beyond).all():
        return f"trace must write 4 + {len(state)} numbers a place and leave the columns beyond alone"
    points, normals, moves = outline[:, :2], outline[:, 2:4], outline[:, 4:]
    if np.abs(np.hypot(*normals.T) - 1.0).max() > 1e-6:
        return f"normals must have length 1, got {np.hypot(*normals.T).round(3).tolist()}"
    if (((points - state[:2]) * normals).sum(axis=1) <= 0.0).any():
        return "normals must point out, away from the center (the first two numbers of the state), which lies inside"
    above = ((points[np.newaxis] - points[:, np.newaxis]) * normals[:, np.newaxis]).sum(axis=2)
    if above.max() > 1e-6 * SIZE:
        return (
            f"the outline must be convex, with normals across it: no place may lie beyond the tangent of another, "
            f"here one lies {above.max():.3g} px beyond"
        )
    for k in range(len(state)):
        ahead, behind = state.copy(), state.copy()
        ahead[k] += STEP
        behind[k] -= STEP
        moved = _traced(family, where, ahead)[:, :2] - _traced(family, where, behind)[:, :2]
        seen = (moved * normals).sum(axis=1) / (2.0 * STEP)
        if np.abs(seen - moves[:, k]).max() > 1e-3 * (1.0 + np.abs(seen).max()):
            return (
                f"column {4 + k} of the outline must say how far it moves along its normal per unit of state[{k}]: "
                f"it moves {seen[0]:.4g}, the column says {moves[0, k]:.4g}"
            )
    return ""


def _broken_answer(family: type[Any], state: Floats) -> str:
    """Rules of `from_state` and `slopes`."""
    count = len(family.parameters)
    shape = family.from_state(state)
    values = np.array([getattr(shape, name) for name in family.parameters], np.float64)
    if values.shape != (count,) or not np.isfinite(values).all():
        return f"parameters must be finite numbers, got {values.tolist()}"
    if np.abs(shape.state[:count] - state[:count]).max() > 1e-6 * SIZE:
        return f"from_state(state).state must be the state again: {state.tolist()} became {shape.state.tolist()}"
    by = slopes(shape)
    if by is not None and (by.shape != (count, count) or not np.isfinite(by).all()):
        return f"slopes must be finite numbers of shape ({count}, {count}), got shape {by.shape}"
    expected, seen = np.eye(count) if by is None else by, np.zeros((count, count))
    for k in range(count):
        ahead = state.copy()
        ahead[k] += STEP
        there = family.from_state(ahead, shape)
        seen[:, k] = (np.array([getattr(there, name) for name in family.parameters]) - values) / STEP
    if np.abs(seen - expected).max() > 2e-2 * (1.0 + np.abs(expected).max()) and not _is_round(expected):
        return (
            "slopes must be the derivative of the parameters by the state, and the state of a family without slopes "
            f"must start with its parameters: seen {seen.round(3).tolist()}, expected {expected.round(3).tolist()}"
        )
    return ""


def _is_round(expected: Floats) -> bool:
    """Whether a direction is undefined here, as that of a circle among the ellipses: nothing to compare."""
    return bool(np.abs(expected).max() > SIZE / 10.0)


def _broken_compiler(family: type[Any], where: Floats, state: Floats) -> str:
    """Numba must be able to compile it; what a user compiled himself is taken as it is."""
    outline = np.full((len(where), 4 + len(state) + 2), np.nan)
    try:
        compile_user_function(family.trace)(state, where, outline)
        size = compile_user_function(family.half_width)(state)
    except Exception as error:  # whatever the compiler may raise
        words = " ".join(str(error).split())[:200]
        return f"Numba cannot compile its trace and half_width: {words}"
    there = _traced(family, where, state)
    if (
        not (np.array_equal(outline, there, equal_nan=True) or np.allclose(outline, there, equal_nan=True))
        or not size > 0.0
    ):
        return "its compiled trace and half_width differ from interpreted Python"
    return ""

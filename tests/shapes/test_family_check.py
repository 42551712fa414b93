"""A family that breaks the contract is refused when the tracker is made, and told why."""

from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import matchset as ms

Floats = npt.NDArray[np.float64]


def trace(state: Floats, places: Floats, outline: Floats) -> None:
    for i in range(outline.shape[0]):
        nx, ny = places[i, 0], places[i, 1]
        outline[i, 0], outline[i, 1] = state[0] + state[2] * nx, state[1] + state[2] * ny
        outline[i, 2], outline[i, 3], outline[i, 4], outline[i, 5], outline[i, 6] = nx, ny, nx, ny, 1.0


def half_width(state: Floats) -> float:
    return float(state[2])


class Disc:
    """A sound family, to be broken."""

    parameters: Any = ("x", "y", "radius")
    trace = staticmethod(trace)
    half_width = staticmethod(half_width)

    def __init__(self, x: float, y: float, radius: float) -> None:
        self.x, self.y, self.radius = x, y, radius

    @property
    def state(self) -> Floats:
        return np.array([self.x, self.y, self.radius])

    @classmethod
    def from_state(cls, state: Floats, near: Any = None) -> Any:  # noqa: ARG003
        return cls(*state.tolist())

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float, like: Any = None) -> Any:  # noqa: ARG003
        return cls(x, y, radius)


def nan_trace(state: Floats, places: Floats, outline: Floats) -> None:
    trace(state, places, outline)
    outline[0, 0] = np.nan


def inward(state: Floats, places: Floats, outline: Floats) -> None:
    trace(state, places, outline)
    for i in range(outline.shape[0]):
        for k in range(2, 6):
            outline[i, k] = -outline[i, k]


def dented(state: Floats, places: Floats, outline: Floats) -> None:
    trace(state, places, outline)
    outline[0, 0] = state[0] + 0.5 * (outline[0, 0] - state[0])
    outline[0, 1] = state[1] + 0.5 * (outline[0, 1] - state[1])


def wrong_slope(state: Floats, places: Floats, outline: Floats) -> None:
    trace(state, places, outline)
    for i in range(outline.shape[0]):
        outline[i, 6] = 2.0


def greedy(state: Floats, places: Floats, outline: Floats) -> None:
    trace(state, places, outline)
    outline[0, 7] = 1.0


def long_normals(state: Floats, places: Floats, outline: Floats) -> None:
    trace(state, places, outline)
    outline[:, 2:4] *= 1.5


def pushy(state: Floats, places: Floats, outline: Floats) -> None:
    trace(state, places, outline)
    state[0] += 1.0


def uncompiled(state: Floats, places: Floats, outline: Floats) -> None:
    trace(state, places, outline)
    str(object())


def never(_: Floats) -> float:
    raise RuntimeError("it rains")


BROKEN: dict[str, dict[str, Any]] = {
    "has no": {"half_width": None},
    "parameters must be": {"parameters": ["x", "y", "radius"]},
    "state must be a float64 array": {"state": property(lambda self: [self.x, self.y, self.radius])},
    "finite numbers a place": {"trace": staticmethod(nan_trace)},
    "normals must point out": {"trace": staticmethod(inward)},
    "must be convex": {"trace": staticmethod(dented)},
    "must say how far it moves": {"trace": staticmethod(wrong_slope)},
    "leave the columns beyond alone": {"trace": staticmethod(greedy)},
    "half_width of from_coarse": {"half_width": staticmethod(lambda state: 3.0 * state[2])},
    "at least three names": {"parameters": ("x", "y")},
    "places(24) must be finite numbers of shape (24, >= 2)": {"places": staticmethod(lambda n: np.ones((n - 1, 2)))},
    "places(24) must be finite": {"places": staticmethod(lambda n: np.full((n, 2), np.nan))},
    "from_coarse must return a Broken": {"from_coarse": staticmethod(lambda *_: (1.0, 2.0, 3.0))},
    "state must be a float64 array of shape (s,)": {"state": property(lambda _: np.zeros((3, 1)))},
    "at least as many finite numbers as there are parameters, 3": {
        "state": property(lambda self: np.array([self.x, self.y]))
    },
    "as many finite numbers": {"state": property(lambda self: np.array([self.x, self.y, np.nan]))},
    "normals must have length 1": {"trace": staticmethod(long_normals)},
    "trace must not change the state": {"trace": staticmethod(pushy)},
    "from_state(state).state must be the state again": {
        "from_state": classmethod(lambda cls, state, *_: cls(state[0], state[1], 2.0 * state[2]))
    },
    "parameters must be finite numbers": {"parameters": ("x", "y", "size"), "size": property(lambda _: np.nan)},
    "slopes must be finite numbers of shape (3, 3)": {"slopes": np.ones((2, 3))},
    "slopes must be the derivative": {"slopes": np.diag((1.0, 1.0, 2.0))},
    "RuntimeError: it rains": {"half_width": staticmethod(never)},
    "Numba cannot compile": {"trace": staticmethod(uncompiled)},
}


@pytest.mark.parametrize("words", list(BROKEN))
def test_a_broken_rule_is_named(words: str) -> None:
    changes = BROKEN[words]
    family: Any = type("Broken", (Disc,), changes)
    if changes == {"half_width": None}:
        family = type("Broken", (), {"parameters": Disc.parameters})
    color = ms.ColorModel.hsv((100, 90, 40), (130, 255, 255))
    with pytest.raises(ValueError, match="Broken is no family of shapes") as refused:
        ms.Tracker(family, color)
    assert words in str(refused.value)


DENTED = [(0.0, 0.0), (4.0, 0.0), (1.0, 1.0), (0.0, 4.0)]


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: ms.Polygon.of(DENTED), "convex"),
        (lambda: ms.Polygon.of([(0, 0), (1, 1), (2, 2)]), "convex"),
        (lambda: ms.Polygon.of([(0, 0), (1, 0)]), "at least 3 points"),
        (lambda: ms.Polygon.of([(0, 0), (1, np.nan), (0, 1)]), "finite"),
        (lambda: ms.Quadrilateral(DENTED), "convex"),
        (lambda: ms.Quadrilateral(np.zeros((3, 2))), "at least 4 points|four"),
        (lambda: ms.Quadrilateral([(0, 0), (1, 0), (1, np.inf), (0, 1)]), "finite"),
        (lambda: ms.Convex.of(np.zeros((20, 20), bool)), "picture|outline|inside"),
        (lambda: ms.Convex.of(lambda t: 10.0 + 9.0 * np.cos(5.0 * t)), "convex"),
        (lambda: ms.Convex.of(lambda t: t * np.nan), "finite"),
    ],
)
def test_what_is_no_convex_outline_is_refused(make: Any, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        make()

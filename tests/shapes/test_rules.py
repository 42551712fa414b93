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

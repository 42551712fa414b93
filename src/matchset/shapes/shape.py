"""The contract of a shape family: few parameters, an outline, and how the outline moves with them."""

from collections.abc import Callable
from typing import ClassVar, Protocol, Self

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]


class Shape(Protocol):
    """What the tracker asks of a family of shapes.

    A family is a frozen struct whose fields are its public parameters (px, rad), the center's x and y first. The
    tracker follows a *state* that starts with those parameters, in their order, and may go on with a few modes: small
    deviations that are held near zero.

    Attributes
    ----------
    trace : callable
        ``trace(state, turns, outline)``, compiled, writes the outline of a state at n places: from turns (n, 2), the
        cosine and sine of angles around the shape, to the rows of outline (n, >= 4 + s): x and y, px, the outward unit
        normal, and by how much the outline moves along it per unit of each number of the state. It must neither raise
        nor allocate. Compiled with `kernel`, or a function that Numba can compile.
    half_width : callable
        ``half_width(state)``, compiled: half the width of a state's outline, px, what its margins and tolerances are
        measured by.
    """

    __struct_fields__: ClassVar[tuple[str, ...]]
    trace: ClassVar[Callable[[Floats, Floats, Floats], None]]
    half_width: ClassVar[Callable[[Floats], float]]

    @property
    def state(self) -> Floats:
        """State of this shape, (s,), s >= the number of parameters."""

    @classmethod
    def from_state(cls, state: Floats) -> Self:
        """Shape of a state; ValueError if it is none."""

    @classmethod
    def from_coarse(cls, x: float, y: float, radius: float) -> Self:
        """Shape from what a search saw: its center and half-width, px."""

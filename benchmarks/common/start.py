"""What a peer is given in the first frame, what it gives back, and what is known of it."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

Image = npt.NDArray[np.uint8]
Circle3 = tuple[float, float, float]
Step = Callable[[Image], Circle3 | None]
Choices = Mapping[str, Sequence[Any]]


class Start(msgspec.Struct, frozen=True):
    """The first frame, and all that anybody is ever told about the truth.

    Parameters
    ----------
    image : ndarray of shape (h, w, 3), uint8
        BGR.
    circle : tuple of 3 floats
        The true x, y and radius in it, px. Peers that need a color may look at the pixels of this disc; those that
        need a circle may begin at it.
    here : bool
        False: the image shows another room than the frames that follow, so only colors can be learned from it.
    fps : float
        Frames per second.
    """

    image: Image
    circle: Circle3
    here: bool = True
    fps: float = 30.0


class Method(NamedTuple):
    """One way to find the ball that people use.

    Attributes
    ----------
    name : str
        For tables.
    needs : str
        What it is given in the first frame: "nothing", a "color" or a "circle".
    parameters : type
        A frozen struct with the defaults.
    choices : mapping of str to sequence
        The values of the parameters that the search tries.
    follow : callable
        ``follow(start, parameters)``: from the first frame to a function that is called with every frame.
    """

    name: str
    needs: str
    parameters: type[Any]
    choices: Choices
    follow: Callable[[Start, Any], Step]

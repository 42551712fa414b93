"""What the network says of a circle, and where it leads: `DiscNetwork`.

It has one layer over the places of a ray and four circular convolutions over the rays, with steps of 1, 2, 4 and 8, so
that each ray knows all others. Of each ray it gives how far the outline is from the circle and how sure that is, where
something hides the ball from what the others show; a circle's center and radius follow by weighted least squares,

    minimize   sum of w (v - dx cos a - dy sin a - dr)^2,

with the inverse of their covariance. From all rays together it gives the log-odds that a ball is there.
"""

import functools
import math
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.polar_patch import DIRECTIONS, RAYS, Circle3, Colors, Image, Patch, read_patch

Floats = npt.NDArray[np.float64]
Weights = dict[str, npt.NDArray[np.float32]]

FILE = Path(__file__).resolve().parent / "weights.npz"
STEPS = {"a": 1, "b": 2, "c": 4, "d": 8}  # format: of the convolutions, in rays
AROUND = {name: np.add.outer(np.arange(RAYS), step * np.arange(-2, 3)) % RAYS for name, step in STEPS.items()}
"""Format: of each ray the five rays that a convolution sees, itself in the middle."""

PRECISION = 30.0  # format: of a circle of which nothing is seen, 1 / radii^2
LOG_PRECISIONS = (-6.0, 8.0)  # format: of a ray, least and largest
MOVES = np.column_stack((DIRECTIONS, np.ones(RAYS)))  # theorem: how the outline moves along the rays with x, y, radius


class FollowParameters(msgspec.Struct, frozen=True):
    """How the network is led to a ball; chosen by hand.

    Parameters
    ----------
    rounds : int
        Most rounds. A streak that begins at its end needs five or more.
    most_step : float
        Longest step of a round, in radii.
    still : float
        Squared step, in standard deviations, from which it has arrived.
    least_radius : float
        Radius below which nothing is seen, px.
    hopeless : float
        Log-odds of a ball at the first circle below which it is not led on: a search looks at many places in vain.
        Balls that were found in nine real clips had -0.5 at least, four fifths of other places less than -1.5.
    """

    rounds: int = 8
    most_step: float = 0.4
    still: float = 0.05
    least_radius: float = 2.0
    hopeless: float = -math.inf


class Seen(NamedTuple):
    """What the network sees around a circle.

    Attributes
    ----------
    step : ndarray of shape (3,), float64
        From the circle to that of the ball, x, y and radius, in radii.
    precision : ndarray of shape (3, 3), float64
        Inverse of the covariance of that, 1 / radii^2.
    log_odds : float
        That there is a ball.
    """

    step: Floats
    precision: Floats
    log_odds: float


class Disc(NamedTuple):
    """A circle that the network was led to.

    Attributes
    ----------
    circle : (x, y, radius)
        px.
    precision : ndarray of shape (3, 3), float64
        Inverse of its covariance, 1 / px^2.
    log_odds : float
        That there is a ball.
    """

    circle: Circle3
    precision: Floats
    log_odds: float


class DiscNetwork:
    """The network with its weights.

    Parameters
    ----------
    weights : dict of str to ndarray, float32
        Of each layer `NAME.w` of shape (in, out) and `NAME.b` of shape (out,): `first`, `a` to `d`, `out`, `cls`.
    """

    def __init__(self, weights: Weights) -> None:
        self._weights = weights

    @staticmethod
    @functools.cache
    def packaged() -> "DiscNetwork":
        """Read the network of the package, once."""
        with np.load(FILE) as file:
            return DiscNetwork({name: file[name].astype(np.float32) for name in file.files})

    def see(self, patch: Patch) -> Seen:
        """Say what a patch shows.

        Parameters
        ----------
        patch : ndarray of shape (64, 32, 6), float32
            See `read_patch`.
        """
        rays = np.maximum(self._layer("first", patch.reshape(RAYS, -1)), 0.0)
        for name, around in AROUND.items():
            rays = rays + np.maximum(self._layer(name, rays[around].reshape(RAYS, -1)), 0.0)
        out = self._layer("out", rays).astype(np.float64)
        there = self._layer("cls", np.concatenate((rays.mean(axis=0), rays.max(axis=0))))
        weights = np.exp(np.clip(out[:, 1], *LOG_PRECISIONS))
        precision = (weights[:, np.newaxis] * MOVES).T @ MOVES + PRECISION * np.eye(3)
        return Seen(np.linalg.solve(precision, (weights * out[:, 0]) @ MOVES), precision, float(there[0]))

    def _layer(self, name: str, values: Patch) -> Patch:
        return np.asarray(values @ self._weights[f"{name}.w"] + self._weights[f"{name}.b"])

    def follow(
        self, image: Image, start: Circle3, limits: FollowParameters, known: Colors | None = None
    ) -> Disc | None:
        """Go from a circle to the ball's, in rounds.

        Parameters
        ----------
        image : ndarray of shape (h, w, 3), (h, w, 1) or (h, w), uint8
            BGR or gray.
        start : (x, y, radius)
            px.
        limits : FollowParameters
        known : Colors, optional
            Colors of the ball, from another picture: see `colors_of`.

        Returns
        -------
        Disc or None
            None where it leads out of the picture or to nothing.
        """
        circle, found = np.array(start), None
        for _ in range(limits.rounds):
            patch = read_patch(image, tuple(circle), known) if circle[2] >= limits.least_radius else None
            if patch is None:
                return None
            seen, scale = self.see(patch), circle[2]
            if found is None and seen.log_odds < limits.hopeless:
                return None
            circle = circle + np.clip(seen.step, -limits.most_step, limits.most_step) * scale
            found = Disc(tuple(circle.tolist()), seen.precision / scale**2, seen.log_odds)
            if seen.step @ seen.precision @ seen.step < limits.still:
                break
        return found if circle[2] >= limits.least_radius else None

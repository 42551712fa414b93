"""What the network says of a circle, and where it leads: `DiscNetwork`.

It has one layer over the places of a ray and four circular convolutions over the rays, with steps of 1, 2, 4 and 8, so
that each ray knows all others. Of each ray it gives how far the outline is from the circle and how sure that is, where
something hides the ball from what the others show; a circle's center and radius follow by weighted least squares,

    minimize   sum of w (v - dx cos a - dy sin a - dr)^2,

with the inverse of their covariance. From all rays together it gives the log-odds that a ball is there.
"""

import functools
import math
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import numpy.typing as npt

from matchset.image.disc_network import look
from matchset.image.disc_network.layers import AROUND, TAPS, TILE, Places, Singles
from matchset.image.disc_network.patch_format import NUMBERS, PLACES, RAYS, Circle3, Colors, Image, Patch
from matchset.image.disc_network.patch_kernel import PATCH_MEMORY
from matchset.image.disc_network.polar_patch import NOTHING
from matchset.image.frame import channels_last
from matchset.numeric.record import new_block

Floats = npt.NDArray[np.float64]
Arrays = dict[str, npt.NDArray[Any]]

FILE = Path(__file__).resolve().parent / "weights.npz"
ALL_LOOKS = 1_000_000  # format: where nobody counts them


class NetworkFollowParameters(msgspec.Struct, frozen=True):
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
    unrest : float
        What the logarithm of the squared step counts beside the log-odds when it is chosen from which circle the next
        look goes on: one that is far from its ball is seen faintly, and one at rest will not be seen better. Fitted by
        logistic regression on 2,245 starts in worse copies of real clips (docs/log/network.md#next-look).
    """

    rounds: int = 8
    most_step: float = 0.4
    still: float = 0.05
    least_radius: float = 2.0
    hopeless: float = -math.inf
    unrest: float = 1.4


class NetworkEvidence(NamedTuple):
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


class _Memories(threading.local):
    """Working memory of each thread that uses a network."""

    memory: look.Memory | None = None


class _Layer(NamedTuple):
    """A layer as kernels read it, see `look.Weights`."""

    outputs: Places
    weights: Singles
    bias: Singles

    @staticmethod
    def of(weights: Arrays, name: str) -> "_Layer":
        """Take a layer, with outputs added whose weights are all 0, so that they are a multiple of `TILE`."""
        by_input, bias = weights[f"{name}.w"].astype(np.float32), weights[f"{name}.b"].astype(np.float32)
        on = weights.get(f"{name}.on", np.arange(len(bias))).astype(np.int64)
        more = 0, -len(on) % TILE
        return _Layer(np.pad(on, more), np.ascontiguousarray(np.pad(by_input, ((0, 0), more)).T), np.pad(bias, more))


class DiscNetwork:
    """The network with its weights; any number of threads may use it.

    Parameters
    ----------
    weights : dict of str to ndarray
        Of each layer `NAME.w` of shape (in, out) and `NAME.b` of shape (out,), float32: `first`, `a` to `d`, `out`,
        `cls`. Of a layer that was pruned also `NAME.on`, which channels these outputs are.
    """

    def __init__(self, weights: Arrays) -> None:
        width = len(weights["out.w"])
        layers = [_Layer.of(weights, name) for name in ("first", *look.STEPS)]
        self._weights = look.Weights(
            tuple(each.outputs for each in layers),
            tuple(each.weights for each in layers),
            tuple(each.bias for each in layers),
            np.ascontiguousarray(weights["out.w"].T, np.float32),
            weights["out.b"].astype(np.float32),
            np.ascontiguousarray(weights["cls.w"][:, 0], np.float32),
            weights["cls.b"].astype(np.float32),
        )
        self._memories, self._width = _Memories(), width

    @staticmethod
    @functools.cache
    def packaged() -> "DiscNetwork":
        """Read the network of the package, once."""
        with np.load(FILE) as file:
            return DiscNetwork({name: file[name] for name in file.files})

    def _memory(self) -> look.Memory:
        """Working memory of this thread."""
        if self._memories.memory is None:
            self._memories.memory = look.Memory(
                patch_block=new_block(PATCH_MEMORY),
                patch=np.zeros((RAYS, PLACES, NUMBERS), np.float32),
                rays=np.zeros((RAYS + 2 * AROUND, self._width), np.float32),
                more=np.zeros((RAYS, max(map(len, self._weights.biases))), np.float32),
                gathered=np.zeros((look.AT_ONCE, TAPS * self._width), np.float32),
                step=np.zeros(3),
                precision=np.zeros((3, 3)),
                inverse=np.zeros((3, 3)),
                right=np.zeros(3),
            )
        return self._memories.memory

    def see(self, patch: Patch) -> NetworkEvidence:
        """Say what a patch shows.

        Parameters
        ----------
        patch : ndarray of shape (64, 32, 6), float32
            See `read_patch`.
        """
        memory = self._memory()
        memory.patch[...] = patch
        log_odds = look.see(self._weights, memory)
        return NetworkEvidence(memory.step.copy(), memory.precision.copy(), log_odds)

    def lead(
        self,
        image: Image,
        starts: Sequence[Circle3],
        limits: NetworkFollowParameters,
        known: Colors | None = None,
        looks: int = ALL_LOOKS,
    ) -> tuple[list[Disc | None], int]:
        """Go from circles to balls, in rounds, all in one call.

        Parameters
        ----------
        image : ndarray of shape (h, w, 3), (h, w, 1) or (h, w), uint8
            BGR or gray.
        starts : sequence of (x, y, radius)
            px.
        limits : NetworkFollowParameters
        known : Colors, optional
            Colors of the ball, from another picture: see `colors_of`.
        looks : int
            How many may be taken in all; starts for which none is left lead to nothing.

        Returns
        -------
        discs : list of Disc or None
            Of each start; None where it leads out of the picture or to nothing.
        looks : int
            How many were taken.
        """
        rows = np.empty((len(starts), look.ROW))
        begin = np.array(starts, np.float64).reshape(-1, 3)
        bounds = look.FollowLimits(
            limits.rounds,
            limits.most_step,
            limits.still,
            limits.least_radius,
            float(limits.hopeless),
            limits.unrest,
        )
        colors, network = NOTHING if known is None else known, (self._weights, self._memory())
        taken = look.follow(channels_last(image), begin, colors, bounds, network, looks, rows)
        return [_disc_of(row) for row in rows], taken

    def follow(
        self, image: Image, start: Circle3, limits: NetworkFollowParameters, known: Colors | None = None
    ) -> Disc | None:
        """Go from one circle to the ball's; see `lead`."""
        return self.lead(image, [start], limits, known)[0][0]


def _disc_of(row: Floats) -> Disc | None:
    """Disc that a start led to."""
    if not row[look.IS_FOUND]:
        return None
    x, y, radius = row[: look.PRECISIONS].tolist()
    return Disc((x, y, radius), row[look.PRECISIONS : look.LOG_ODDS].reshape(3, 3).copy(), float(row[look.LOG_ODDS]))

"""Which outputs of a network never answer: `without_silent`, and `with_silent`, which adds them again."""

from typing import Any

import numpy as np
import numpy.typing as npt

from matchset.image.disc_network.layers import TAPS
from matchset.image.disc_network.look import STEPS
from matchset.image.disc_network.patch_format import NUMBERS, PLACES, RAYS

Arrays = dict[str, npt.NDArray[Any]]
Singles = npt.NDArray[np.float32]

AT_ONCE = 250  # patches


def without_silent(weights: Arrays, patches: npt.NDArray[np.floating[Any]]) -> Arrays:
    """Leave out the outputs of the convolutions that are positive in no ray of any patch.

    Parameters
    ----------
    weights : dict of str to ndarray
        See `DiscNetwork`, with all outputs.
    patches : ndarray of shape (n, 64, 32, 6)

    Returns
    -------
    dict of str to ndarray
        With `NAME.on`, the channels of the outputs that are left.
    """
    answered = {name: np.zeros(len(weights[f"{name}.b"]), bool) for name in STEPS}
    for begin in range(0, len(patches), AT_ONCE):
        some = np.asarray(patches[begin : begin + AT_ONCE], np.float32)
        rays = _rectified(some.reshape(len(some), RAYS, PLACES * NUMBERS), weights, "first")
        for name, step in STEPS.items():
            more = _rectified(_around(rays, step), weights, name)
            answered[name] |= (more > 0.0).any(axis=(0, 1))
            rays = rays + more
    pruned = dict(weights)
    for name, live in answered.items():
        on = np.flatnonzero(live)
        pruned[f"{name}.w"], pruned[f"{name}.b"] = weights[f"{name}.w"][:, on], weights[f"{name}.b"][on]
        pruned[f"{name}.on"] = on.astype(np.int16)
    return pruned


def with_silent(weights: Arrays) -> Arrays:
    """Add the outputs that were left out, with weights of 0."""
    whole, width = {name: each for name, each in weights.items() if not name.endswith(".on")}, len(weights["out.w"])
    for name in STEPS:
        on, by_input, bias = weights.get(f"{name}.on"), whole[f"{name}.w"], whole[f"{name}.b"]
        if on is not None:
            whole[f"{name}.w"] = np.zeros((len(by_input), width), by_input.dtype)
            whole[f"{name}.b"] = np.zeros(width, bias.dtype)
            whole[f"{name}.w"][:, on], whole[f"{name}.b"][on] = by_input, bias
    return whole


def _rectified(inputs: Singles, weights: Arrays, name: str) -> Singles:
    by_input, bias = (weights[f"{name}.{kind}"].astype(np.float32) for kind in ("w", "b"))
    return np.asarray(np.maximum(inputs @ by_input + bias, 0.0))


def _around(rays: Singles, step: int) -> Singles:
    """Numbers of the rays that a convolution sees, one behind the other."""
    return np.concatenate([np.roll(rays, -step * (tap - TAPS // 2), axis=1) for tap in range(TAPS)], axis=2)

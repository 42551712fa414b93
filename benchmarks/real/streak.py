"""A ball smeared by its motion, fitted as a disc swept along a straight line: `fit_streak`.

The picture around the ball is modeled as wall times (1 - cover) + ball times cover, where the cover of a pixel is the
share of the exposure during which the disc lay over it. Wall and ball are linear in x and y for each color channel and
solved for at every step (variable projection); center, radius and sweep are found by nonlinear least squares. This
needs a wall without edges, and an exposure with constant light and speed. Where the camera stands still the wall may
have any pattern: `still_background` gives it.
"""

from collections.abc import Sequence

import cv2
import msgspec
import numpy as np
import numpy.typing as npt
from scipy.optimize import least_squares

Floats = npt.NDArray[np.float64]
Circle3 = tuple[float, float, float]


class StreakParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How a streak is modeled; chosen on rendered streaks, see `tests/benchmarks/test_labelling.py`.

    Parameters
    ----------
    places : int
        Places of the disc along its sweep.
    softness : float
        Width of the disc's rim, px.
    window : float
        Half the side of the window around the start, in radii.
    scale : float
        Residual at which the loss turns from square to linear, gray levels.
    """

    places: int = 25
    softness: float = 2.0
    window: float = 2.2
    scale: float = 3.0


def still_background(images: Sequence[npt.NDArray[np.uint8]]) -> npt.NDArray[np.uint8]:
    """Return what a still camera sees behind a ball that moves: the median of each pixel over many frames."""
    return np.asarray(np.median(np.stack(images), axis=0), dtype=np.uint8)


def fit_streak(
    image: npt.NDArray[np.uint8],
    start: Circle3,
    background: npt.NDArray[np.uint8] | None = None,
    parameters: StreakParameters | None = None,
) -> tuple[Circle3, float]:
    """Fit a swept disc near a start.

    Parameters
    ----------
    image : uint8 array (height, width, 3)
        BGR.
    start : tuple of three floats
        Center of the streak x, y and the ball's radius, px.
    background : uint8 array (height, width, 3), optional
        The same view without the ball; without it, the wall is linear in x and y.
    parameters : StreakParameters, optional

    Returns
    -------
    tuple of three floats
        The center of the streak, where the ball was in the middle of the exposure, and the ball's radius, px.
    float
        The length of the sweep, px.
    """
    chosen = parameters or StreakParameters()
    height, width = image.shape[:2]
    half = chosen.window * start[2]
    left, right = max(int(start[0] - half), 0), min(int(start[0] + half) + 1, width)
    top, bottom = max(int(start[1] - half), 0), min(int(start[1] + half) + 1, height)
    step = max(round(start[2] / 12), 1)
    kernel = step + 1 - step % 2  # an even one would move the picture by half a pixel

    def sampled(picture: npt.NDArray[np.uint8]) -> Floats:
        smooth = cv2.blur(picture, (kernel, kernel))
        return np.asarray(smooth[top:bottom:step, left:right:step].reshape(-1, 3), dtype=np.float64)

    rows, columns = np.mgrid[top:bottom:step, left:right:step].astype(np.float64)
    colors = sampled(image)
    wall = None if background is None else sampled(background)
    across, down = columns.ravel() - start[0], rows.ravel() - start[1]
    plane = np.column_stack([np.ones_like(across), across / half, down / half])

    def misfit(state: Floats) -> Floats:
        cover = _cover(state, across, down, chosen)[:, None]
        basis = plane * cover if wall is not None else np.hstack([plane * (1.0 - cover), plane * cover])
        rest = colors if wall is None else colors - wall * (1.0 - cover)
        return np.asarray((basis @ np.linalg.lstsq(basis, rest, rcond=None)[0] - rest).ravel())

    angles = np.arange(4) * np.pi / 4.0
    begins = [(0.0, 0.0, start[2], 0.6 * start[2] * np.cos(a), 0.6 * start[2] * np.sin(a)) for a in angles]
    best = min(begins, key=lambda begin: float(np.abs(misfit(np.array(begin))).sum()))
    x, y, radius, *sweep = least_squares(misfit, best, loss="soft_l1", f_scale=chosen.scale, x_scale=start[2]).x
    return (float(start[0] + x), float(start[1] + y), float(radius)), float(2.0 * np.hypot(*sweep))


def _cover(state: Floats, across: Floats, down: Floats, parameters: StreakParameters) -> Floats:
    """Return the share of the exposure (n,) that the disc covers each pixel."""
    x, y, radius, half_x, half_y = state
    along = (np.arange(parameters.places) + 0.5) * (2.0 / parameters.places) - 1.0
    distance = np.hypot(across - x - along[:, None] * half_x, down - y - along[:, None] * half_y)
    inside = np.clip((radius - distance) / parameters.softness + 0.5, 0.0, 1.0)
    return np.asarray(inside.mean(axis=0))

"""Smooths the noise of a film's pictures, for an encoder that cannot be told to: `NoiseSmoother`."""

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

from matchset.app.films.codecs import Picture

Floats = npt.NDArray[np.float32]

SPARSE = 8  # format: of so many rows and columns one tells the noise
LARGEST = 1.26  # theorem: median of the largest of three absolute values, standard normal: Phi^-1((1 + 0.5^(1/3)) / 2)


class SmoothingParameters(msgspec.Struct, frozen=True, kw_only=True):
    """How pictures are smoothed, over time where nothing moves. Chosen by: `matchset demo` below 2 MB, decision 139.

    Parameters
    ----------
    blur : float
        Of each picture, standard deviation, px. More makes smaller files and softer edges.
    share : float
        Of a new picture where nothing moves. Less averages more pictures, and follows slow changes later.
    window : int
        Over so many pixels a change is averaged to see whether something moves. More tells motion from noise better,
        and smears small things.
    motion : float
        Mean change from which on the new picture counts in full, gray levels; below, by its square.
    line, line_noise : float
        Change of one pixel from which on it counts in full around it: gray levels, and standard deviations of the
        changes in this picture; both: thin lines and letters, which noise is not.
    """

    blur: float = 1.4
    share: float = 0.05
    window: int = 9
    motion: float = 25.0
    line: float = 45.0
    line_noise: float = 6.0


class NoiseSmoother:
    """A recursive filter in time that lets motion through.

    Parameters
    ----------
    parameters : SmoothingParameters, optional
    """

    def __init__(self, parameters: SmoothingParameters | None = None) -> None:
        self._parameters = parameters or SmoothingParameters()
        self._last: Floats | None = None

    def smooth(self, picture: Picture) -> Picture:
        """Return the next BGR picture, smoothed."""
        limits = self._parameters
        new = np.asarray(cv2.GaussianBlur(picture, (0, 0), limits.blur), np.float32)
        if self._last is None:
            self._last = new
        change = new - self._last
        size = limits.window, limits.window
        moved = np.abs(np.asarray(cv2.blur(change, size), np.float32)).max(axis=2) / limits.motion
        largest = np.abs(change).max(axis=2)
        noise = float(np.median(largest[::SPARSE, ::SPARSE])) / LARGEST
        lines = np.asarray(largest > max(limits.line, limits.line_noise * noise), np.uint8)
        share = np.clip(moved * moved, limits.share, 1.0)
        share[np.asarray(cv2.dilate(lines, np.ones((5, 5), np.uint8))) > 0] = 1.0
        self._last = self._last + share[..., None] * change
        return np.rint(self._last).astype(np.uint8)

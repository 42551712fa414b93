"""How a convex outline is turned: by its radial profile, and which turns leave it as it is."""

import math

import cv2
import msgspec
import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]
STEPS = 120  # geometry: angles of a profile


class OrientationParameters(msgspec.Struct, frozen=True):
    """Which orientations of a template are tried, and which are the same.

    Chosen by hand; `tests/shapes/test_found_and_followed.py` would show a change.

    Parameters
    ----------
    least_angle : float
        Angle between two orientations that are both tried, rad.
    least_match : float
        Share of the range from the worst to the best match from which on an orientation is tried.
    corner_tolerance : float
        Distance between two corners that are taken for the same, in sizes of the template.
    """

    least_angle: float = 0.2 * math.pi
    least_match: float = 0.7
    corner_tolerance: float = 0.02


DEFAULT = OrientationParameters()


def profile(corners: Floats) -> Floats:
    """Support function of a polygon, ``h(t) = max of p . (cos t, sin t)``, at `STEPS` even angles."""
    t = 2.0 * math.pi * np.arange(STEPS) / STEPS
    found: Floats = (corners @ np.vstack((np.cos(t), np.sin(t)))).max(axis=0)
    return found


def likely_turns(hull: Floats, corners: Floats, most: int = 3) -> list[float]:
    """Angles by which a template must be turned to lie on a hull, likeliest first.

    Parameters
    ----------
    hull, corners : ndarray of shape (m, 2), (k, 2), float64
        Both about their centers and of the same size.
    most : int
        How many at most.

    Returns
    -------
    list of float
        rad.
    """
    there, own = profile(hull), profile(corners)
    match = np.fft.irfft(np.fft.rfft(there) * np.conj(np.fft.rfft(own)), STEPS)
    least, spread = match.min(), match.max() - match.min()
    found: list[float] = []
    for step in np.argsort(-match, kind="stable"):
        if len(found) == most or match[step] < least + DEFAULT.least_match * spread:
            break
        before, after = match[step - 1], match[(step + 1) % STEPS]
        if match[step] < max(before, after):
            continue
        bend = before + after - 2.0 * match[step]
        off = 0.5 * (before - after) / bend if bend < 0.0 else 0.0
        turn = 2.0 * math.pi * (float(step) + float(off)) / STEPS
        turn -= 2.0 * math.pi * round(turn / (2.0 * math.pi))
        if all(abs(math.remainder(turn - other, 2.0 * math.pi)) > DEFAULT.least_angle for other in found):
            found.append(turn)
    return found or [0.0]


def root_of(corners: Floats) -> Floats:
    """Symmetric root of the second moments of a polygon about its center, (2, 2)."""
    size = max(float(np.abs(corners).max()), 1e-12)
    moments = cv2.moments((corners / size).astype(np.float32).reshape(-1, 1, 2))
    area = max(moments["m00"], 1e-12)
    square = np.array([[moments["mu20"], moments["mu11"]], [moments["mu11"], moments["mu02"]]]) / area
    values, vectors = np.linalg.eigh(square)
    found: Floats = size * (vectors @ np.diag(np.sqrt(np.maximum(values, 1e-6))) @ vectors.T)
    return found


def symmetries(corners: Floats) -> list[Floats]:
    """Matrices of positive determinant that map a polygon about its center onto itself, the identity first."""
    found: list[Floats] = [np.eye(2)]
    size = float(np.hypot(corners[:, 0], corners[:, 1]).max())
    for shift in range(1, len(corners)):
        image = np.roll(corners, -shift, axis=0)
        matrix = np.linalg.lstsq(corners, image, rcond=None)[0].T
        if np.abs(corners @ matrix.T - image).max() < DEFAULT.corner_tolerance * size:
            found.append(np.asarray(matrix, np.float64))
    return found

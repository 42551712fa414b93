"""A meadow: the background for green balls."""

import cv2
import numpy as np
import numpy.typing as npt

Picture = npt.NDArray[np.float32]

BLADES = 26_000  # geometry: of a picture of 640 x 480 px
GREEN = np.array((42.0, 118.0, 78.0), np.float32)  # format: BGR, the middle of all blades


def grass(seed: int, width: int, height: int) -> Picture:
    """Draw a lawn as seen from above, blade by blade, longer ones nearer to the lower edge.

    Parameters
    ----------
    seed : int
        Decides everything; not negative.
    width, height : int
        Of the picture, px.

    Returns
    -------
    ndarray of shape (h, w, 3), float32
        BGR, 0 ... 255.
    """
    rng = np.random.default_rng((seed, 0x6A55))
    picture = np.empty((height, width, 3), np.float32)
    picture[:] = 0.45 * GREEN
    count = BLADES * width * height // (640 * 480)
    y = np.sort(rng.uniform(-0.02, 1.06, count)) * height
    x = rng.uniform(-0.02, 1.02, count) * width
    length = (0.012 + 0.035 * y / height) * height * rng.uniform(0.5, 1.4, count)
    lean = rng.normal(0.0, 0.5, count)
    patches = _patches(rng, width, height)
    place = patches[np.clip(y, 0, height - 1).astype(int), np.clip(x, 0, width - 1).astype(int)]
    bright = (0.55 + 0.75 * rng.random(count) + 0.3 * place)[:, None]
    yellow = np.clip(rng.normal(0.0, 0.18, count) + 0.2 * place, -0.2, 0.6)[:, None]
    colors = np.clip(bright * (GREEN + yellow * np.array((-14.0, 34.0, 70.0))), 0.0, 255.0)
    thickness = np.where(length > 0.035 * height, 2, 1)
    tip_x, tip_y = x + length * np.sin(lean), y - length * np.cos(lean)
    for k in range(count):
        begin, end = (round(16 * x[k]), round(16 * y[k])), (round(16 * tip_x[k]), round(16 * tip_y[k]))
        cv2.line(picture, begin, end, colors[k].tolist(), int(thickness[k]), cv2.LINE_8, 4)
    return np.asarray(cv2.GaussianBlur(picture, (0, 0), 0.7), dtype=np.float32)


def _patches(rng: np.random.Generator, width: int, height: int) -> Picture:
    """Where the lawn is lighter, about -1 ... 1."""
    coarse = rng.normal(0.0, 0.6, (6, 8)).astype(np.float32)
    return np.asarray(cv2.resize(coarse, (width, height), interpolation=cv2.INTER_CUBIC), dtype=np.float32)

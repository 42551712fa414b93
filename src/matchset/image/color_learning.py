"""From pixels of target and background to the log-odds of a table."""

import cv2
import numpy as np
import numpy.typing as npt

from matchset.image.chroma import chroma, density, look_up

UNKNOWN = 0.06, 0.12  # shares of target and background that may have any color at all


def bin_centers() -> npt.NDArray[np.float32]:
    """BGR value in the middle of each of the 32 x 32 x 32 cells, (32768, 3)."""
    level = np.arange(32, dtype=np.float32) * 8.0 + 3.5
    return np.stack(np.meshgrid(level, level, level, indexing="ij"), axis=-1).reshape(-1, 3)


def learned_color(target: npt.NDArray[np.uint8], background: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """Log-odds of the BGR cells: chroma counts, lightness only where the background says so."""
    inside = chroma(target)
    width = np.clip(inside[:, :2].std(axis=0) * len(inside) ** (-1 / 6), 0.018, 0.06)
    wanted = density(inside, (float(width[0]), float(width[1]), 0.9))
    other = density(chroma(background), (0.02, 0.02, 0.3))
    cells = chroma(bin_centers())
    uniform = 1.0 / (0.25 * wanted.size)
    odds = (look_up(wanted, cells) * (1 - UNKNOWN[0]) + UNKNOWN[0] * uniform) / (
        look_up(other, cells) * (1 - UNKNOWN[1]) + UNKNOWN[1] * uniform
    )
    return np.asarray(np.log(odds), np.float32)


def learned_gray(target: npt.NDArray[np.uint8], background: npt.NDArray[np.uint8]) -> npt.NDArray[np.float32]:
    """Log-odds of the 256 gray values."""
    shares = []
    for pixels, unknown in zip((target, background), UNKNOWN, strict=True):
        counts = np.bincount(pixels.ravel(), minlength=256).astype(np.float32)
        smooth = cv2.GaussianBlur(counts.reshape(1, -1), (0, 0), 6.0, borderType=cv2.BORDER_REPLICATE).ravel()
        shares.append(smooth / smooth.sum() * (1 - unknown) + unknown / 256.0)
    return np.asarray(np.log(shares[0] / shares[1]), np.float32)
